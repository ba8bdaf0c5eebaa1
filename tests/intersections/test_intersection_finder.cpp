#include "souple/geometry/builders.h"
#include "souple/intersections/intersection_finder.h"
#include "tests/collision/random.h"
#include "tests/count_allocations.h"
#include "tests/intersections/crossings.h"

#include <tuple>

#include <gtest/gtest.h>

namespace souple::test_intersections_intersection_finder {

/// Crumpled sheets that pass through themselves and one another.
class CrumpledSheets {
 public:
  CrumpledSheets(int count, int columns, double roughness, const Vec3d& origin) {
    const TriangleMesh mesh = grid(columns, columns, 1);
    meshes_.assign(static_cast<std::size_t>(count), mesh.triangles);
    test::Random random(7);
    for (const auto& triangles : meshes_) {
      const auto begin = static_cast<std::uint32_t>(position_.size());
      std::vector<Vec3f> positions;
      for (const Vec3d& x : mesh.positions) {
        const Vec3d exact = origin + x + random.point(-1, 1) * (roughness / columns);
        const Vec3f rounded(exact);
        const Vec3f rest(exact - Vec3d(rounded));
        position_.push_back({rounded.x, rounded.y, rounded.z, 1});
        offset_.push_back({rest.x, rest.y, rest.z, 0});
        positions.emplace_back(exact - origin);
      }
      checker_.add(positions, triangles);
      ContactSurface surface;
      surface.begin = begin, surface.end = static_cast<std::uint32_t>(position_.size());
      surface.triangles = triangles;
      surfaces_.push_back(surface);
    }
  }

  ParticleView view() { return {position_, offset_, offset_}; }
  std::vector<ContactSurface>& surfaces() { return surfaces_; }
  const test::CrossingCounter& checker() const { return checker_; }

 private:
  std::vector<Vec4f> position_, offset_;
  std::vector<std::vector<Triangle>> meshes_;
  std::vector<ContactSurface> surfaces_;
  test::CrossingCounter checker_;
};

/// Number of intersections between two objects, and of self-intersections.
std::pair<std::size_t, std::size_t> count(const IntersectionFinder& finder) {
  std::size_t between = 0, within = 0;
  for (const EdgeIntersection& e : finder.intersections()) ++(e.edge_surface == e.surface ? within : between);
  return {between, within};
}

TEST(IntersectionFinder, FindsWhatTheCheckerCounts) {
  const auto threads = make_threads(Threading::pool, 2);
  for (const double far : {0.0, 1000.0}) {
    CrumpledSheets sheets(3, 20, 2, {far, -far, far / 2});
    for (ContactSurface& surface : sheets.surfaces()) surface.self_collision = true;
    IntersectionFinder finder(sheets.surfaces());
    finder.find(sheets.view(), *threads);
    EXPECT_GT(finder.intersections().size(), 1000u);
    EXPECT_EQ(finder.intersections().size(), sheets.checker().crossings()) << far;
    for (std::size_t k = 1; k < finder.intersections().size(); ++k) {
      const EdgeIntersection &a = finder.intersections()[k - 1], &b = finder.intersections()[k];
      EXPECT_LT(std::tie(a.edge, a.triangle), std::tie(b.edge, b.triangle));
    }
    for (const EdgeIntersection& e : finder.intersections()) {
      Vec3f gap;  // between the two intersection points
      for (std::size_t k = 1; k < 5; ++k)
        gap += sheets.view().difference(e.particle[k], e.particle[0]) * e.c[k];
      EXPECT_LT(length(gap), 1e-5f);
    }
  }
}

TEST(IntersectionFinder, SearchesOnlyCollidingSurfaces) {
  const auto threads = make_threads(Threading::serial, 1);
  CrumpledSheets sheets(2, 12, 2, {});
  const auto found = [&] {
    IntersectionFinder finder(sheets.surfaces());
    finder.find(sheets.view(), *threads);
    return count(finder);
  };
  const auto [between, none_within] = found();
  EXPECT_GT(between, 100u);
  EXPECT_EQ(none_within, 0u);
  for (ContactSurface& surface : sheets.surfaces()) surface.self_collision = true;
  EXPECT_EQ(found().first, between);
  EXPECT_GT(found().second, 100u);
  // With different groups the sheets do not collide.
  sheets.surfaces()[0].filter = {2, 2}, sheets.surfaces()[1].filter.mask = 1;
  EXPECT_EQ(found().first, 0u);
  EXPECT_GT(found().second, 100u);
}

TEST(IntersectionFinder, IgnoresJoinedPairs) {
  const auto threads = make_threads(Threading::serial, 1);
  CrumpledSheets sheets(2, 12, 2, {});
  IntersectionFinder finder(sheets.surfaces());
  finder.find(sheets.view(), *threads);
  const std::size_t before = finder.intersections().size();
  const EdgeIntersection first = finder.intersections()[0];
  finder = IntersectionFinder(sheets.surfaces(), ParticlePairs({{first.particle[3], first.particle[0]}}));
  finder.find(sheets.view(), *threads);
  EXPECT_LT(finder.intersections().size(), before);
  for (const EdgeIntersection& e : finder.intersections())
    EXPECT_FALSE(e.edge == first.edge && e.triangle == first.triangle);
}

// Boxes that lie face on face, aligned to the bit, only touch. Overlapping boxes intersect.
TEST(IntersectionFinder, TouchingSurfacesDoNotIntersect) {
  const auto threads = make_threads(Threading::serial, 1);
  const TriangleMesh mesh = box({1, 1, 1}, 4);
  for (const double offset : {1.0, 0.75, 0.5, 0.9}) {
    std::vector<Vec4f> position, still(2 * mesh.positions.size());
    for (int k = 0; k < 2; ++k)
      for (const Vec3d& x : mesh.positions)
        position.push_back({float(x.x), float(x.y + k * offset), float(x.z), 1});
    const auto n = static_cast<std::uint32_t>(mesh.positions.size());
    std::vector<ContactSurface> surfaces(2);
    for (std::uint32_t k = 0; k < 2; ++k)
      surfaces[k].begin = k * n, surfaces[k].end = (k + 1) * n, surfaces[k].triangles = mesh.triangles,
      surfaces[k].rest = mesh.positions;
    IntersectionFinder finder(surfaces);
    finder.find({position, still, still}, *threads);
    EXPECT_EQ(finder.intersections().empty(), offset == 1.0) << offset;
    EXPECT_TRUE(finder.is_closed(0));
  }
}

TEST(IntersectionFinder, AWarmFindAllocatesNothing) {
  const auto threads = make_threads(Threading::pool, 2);
  CrumpledSheets sheets(2, 30, 1.5, {});
  IntersectionFinder finder(sheets.surfaces());
  for (int k = 0; k < 3; ++k) finder.find(sheets.view(), *threads);
  const long before = test::allocations();
  finder.find(sheets.view(), *threads);
  EXPECT_EQ(test::allocations() - before, 0);
  EXPECT_FALSE(finder.intersections().empty());
}

}  // namespace souple::test_intersections_intersection_finder
