#include "souple/broad_phase/object_pairs.h"
#include "souple/broad_phase/spatial_hash.h"
#include "souple/broad_phase/surface_elements.h"
#include "souple/geometry/builders.h"
#include "tests/collision/random.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include <gtest/gtest.h>

namespace souple::test_broad_phase_spatial_hash {

std::vector<Bounds> random_boxes(std::size_t count, double cube, double largest, std::uint64_t seed) {
  test::Random random(seed);
  std::vector<Bounds> boxes;
  for (std::size_t b = 0; b < count; ++b) {
    const Vec3f lo(random.point(-cube, cube));
    const double size = largest * std::pow(random.uniform(0, 1), 6);
    boxes.push_back({lo, lo + Vec3f(random.point(0, size))});
  }
  return boxes;
}

std::vector<std::uint32_t> overlapping(const std::vector<Bounds>& boxes, const Bounds& box) {
  std::vector<std::uint32_t> result;
  for (std::uint32_t b = 0; b < boxes.size(); ++b)
    if (overlap(boxes[b], box)) result.push_back(b);
  return result;
}

// Queries from points to the whole cube find the boxes that a test of all boxes finds.
TEST(SpatialHash, FindsWhatOverlapsABoxOfAnySize) {
  const auto threads = make_threads(Threading::pool, 2);
  const std::vector<Bounds> boxes = random_boxes(3000, 1, 0.5, 1);
  SpatialHash hash;
  hash.build(boxes, SpatialHash::choose_cell_size(boxes), *threads);
  test::Random random(2);
  std::size_t sum = 0;
  for (int query = 0; query < 300; ++query) {
    const Vec3f lo(random.point(-1, 1));
    const Bounds box{lo, lo + Vec3f(random.point(0, std::pow(0.5, query % 12)))};
    std::vector<std::uint32_t> found;
    hash.find(box, found);
    ASSERT_EQ(found, overlapping(boxes, box));
    sum += found.size();
  }
  EXPECT_GT(sum, 1000u);
  std::vector<std::uint32_t> all;
  hash.find({{-1e30f, -1e30f, -1e30f}, {1e30f, 1e30f, 1e30f}}, all);
  EXPECT_EQ(all.size(), boxes.size());
}

TEST(SpatialHash, EachPairHasOneWhoFindsIt) {
  const auto threads = make_threads(Threading::pool, 2);
  const std::vector<Bounds> boxes = random_boxes(2000, 1, 0.6, 3);
  SpatialHash hash;
  hash.build(boxes, SpatialHash::choose_cell_size(boxes), *threads);
  std::vector<std::pair<std::uint32_t, std::uint32_t>> found, expected;
  for (std::uint32_t a = 0; a < boxes.size(); ++a) {
    std::vector<std::uint32_t> partners;
    hash.find_partners(a, partners);
    for (const std::uint32_t b : partners) found.push_back(std::minmax(a, b));
    for (const std::uint32_t b : overlapping(boxes, boxes[a]))
      if (b > a) expected.push_back({a, b});
  }
  std::sort(found.begin(), found.end());
  EXPECT_EQ(found, expected);
}

// Covers both searches, in boxes of all sizes: also the first box, the last one, all of them and none.
TEST(SpatialHash, LeavesOutARangeOfBoxes) {
  const auto threads = make_threads(Threading::pool, 2);
  const std::vector<Bounds> boxes = random_boxes(2000, 1, 0.6, 4);
  SpatialHash hash;
  hash.build(boxes, SpatialHash::choose_cell_size(boxes), *threads);
  test::Random random(5);
  for (std::uint32_t a = 0; a < 400; ++a) {
    const auto ends = std::minmax({static_cast<std::uint32_t>(random.uniform(0, 2000)),
                                   static_cast<std::uint32_t>(random.uniform(0, 2000))});
    std::uint32_t first = ends.first, last = ends.second;
    if (a % 4 == 1) first = 0;
    if (a % 4 == 2) last = 2000;
    const auto without = [&](std::vector<std::uint32_t> found) {
      found.erase(
          std::remove_if(found.begin(), found.end(), [&](std::uint32_t b) { return first <= b && b < last; }),
          found.end());
      return found;
    };
    const double side = std::pow(0.5, a % 12);
    const Vec3f lo(random.point(-1, 1));
    const Bounds box{lo, lo + Vec3f(random.point(0, side))};
    std::vector<std::uint32_t> found, all, partners;
    hash.find(box, {first, last}, found);
    ASSERT_EQ(found, without(overlapping(boxes, box)));
    hash.find_partners(a, all);
    hash.find_partners(a, {first, last}, partners);
    ASSERT_EQ(partners, without(all));
  }
}

// One huge box costs entries in few cells, and does not add entries of other boxes.
TEST(SpatialHash, AHugeBoxCostsNothing) {
  const auto threads = make_threads(Threading::serial, 1);
  std::vector<Bounds> boxes;
  test::Random random(6);
  for (int b = 0; b < 10000; ++b) {
    const Vec3f lo(random.point(-1, 1));
    boxes.push_back({lo, lo + Vec3f{0.02f, 0.02f, 0.02f}});
  }
  SpatialHash hash;
  hash.build(boxes, SpatialHash::choose_cell_size(boxes), *threads);
  const std::size_t before = hash.entries();
  EXPECT_LE(before, 8 * boxes.size());
  boxes.push_back({{-20, -20, -20}, {20, 20, 20}});
  hash.build(boxes, SpatialHash::choose_cell_size(boxes), *threads);
  EXPECT_LE(hash.entries(), before + 8);
}

using Pairs = std::vector<std::pair<std::uint32_t, std::uint32_t>>;

Pairs brute_force(const std::vector<Bounds>& boxes) {
  Pairs pairs;
  for (std::uint32_t a = 0; a < boxes.size(); ++a)
    for (std::uint32_t b = a + 1; b < boxes.size(); ++b)
      if (overlap(boxes[a], boxes[b])) pairs.emplace_back(a, b);
  return pairs;
}

Pairs swept(const std::vector<Bounds>& boxes) {
  BoxSweep sweep;
  const auto found = sweep.find(boxes);
  Pairs pairs(found.begin(), found.end());
  std::sort(pairs.begin(), pairs.end());
  return pairs;
}

std::vector<Bounds> random_boxes(int count, const Vec3d& room, test::Random& random) {
  std::vector<Bounds> boxes;
  for (int k = 0; k < count; ++k) {
    const Vec3d at = random.point(-1, 1), half = random.point(0, 0.1);
    const Vec3d center{at.x * room.x, at.y * room.y, at.z * room.z};
    boxes.push_back({Vec3f(center - half), Vec3f(center + half)});
  }
  return boxes;
}

TEST(BoxSweep, FindsAllPairsOfBoxesThatOverlap) {
  test::Random random(1);
  for (const Vec3d& room : {Vec3d{1, 1, 1}, Vec3d{0.1, 3, 0.1}, Vec3d{2, 0, 2}, Vec3d{0, 0, 0}}) {
    const std::vector<Bounds> boxes = random_boxes(200, room, random);
    EXPECT_FALSE(brute_force(boxes).empty());
    EXPECT_EQ(swept(boxes), brute_force(boxes));
  }
}

TEST(BoxSweep, BoxesThatAreEmptyInfiniteOrNoNumbers) {
  constexpr float inf = std::numeric_limits<float>::infinity(), nan = std::numeric_limits<float>::quiet_NaN();
  test::Random random(2);
  std::vector<Bounds> boxes = random_boxes(50, {1, 1, 1}, random);
  boxes[7] = {{inf, inf, inf}, {-inf, -inf, -inf}};
  boxes[19] = {{-inf, -inf, -inf}, {inf, inf, inf}};
  boxes[23].lo.x = nan, boxes[31].hi = {nan, nan, nan}, boxes[40].lo = {nan, nan, nan};
  EXPECT_EQ(swept(boxes), brute_force(boxes));
  EXPECT_TRUE(swept({}).empty());
}

TEST(ObjectPairs, HoldsWhatWasAddedInEitherOrder) {
  test::Random random(3);
  ObjectPairs pairs;
  EXPECT_FALSE(pairs.contains(0, 0));
  for (int round = 0; round < 2; ++round) {
    std::set<std::pair<std::uint32_t, std::uint32_t>> expected;
    for (int k = 0; k < 500; ++k) {
      const Vec3d p = random.point(0, 60);
      const auto a = static_cast<std::uint32_t>(p.x), b = static_cast<std::uint32_t>(p.y);
      pairs.add(a, b);
      expected.insert(std::minmax(a, b));
    }
    for (std::uint32_t a = 0; a < 60; ++a)
      for (std::uint32_t b = 0; b < 60; ++b)
        EXPECT_EQ(pairs.contains(a, b), expected.count(std::minmax(a, b)) > 0) << a << ", " << b;
    pairs.clear();
    EXPECT_TRUE(pairs.empty());
    EXPECT_FALSE(pairs.contains(1, 2));
  }
}

// Every vertex and edge of a mesh has one owner, and the edges of the elements agree with edges().
TEST(SurfaceElements, EachVertexAndEdgeHasOneOwner) {
  const TriangleMesh mesh = grid(7, 5, 1.0);
  SurfaceElements elements;
  elements.add_triangles(mesh.triangles, 100, 0);
  elements.add_triangles(mesh.triangles, 200, 1);
  std::multiset<std::uint32_t> particles, edges;
  for (const SurfaceElement& element : elements.elements()) {
    ASSERT_EQ(element.corners, 3);
    for (unsigned k = 0; k < 3; ++k) {
      Edge side{element.particle[k], element.particle[(k + 1) % 3]},
          listed = elements.edges()[element.edge[k]];
      std::sort(side.begin(), side.end());
      std::sort(listed.begin(), listed.end());
      EXPECT_EQ(side, listed);
      EXPECT_EQ(elements.edge_objects()[element.edge[k]], element.object);
      if (element.owns_particle >> k & 1) particles.insert(element.particle[k]);
      if (element.owns_edge >> k & 1) edges.insert(element.edge[k]);
    }
  }
  EXPECT_EQ(particles.size(), 70u);
  EXPECT_EQ(std::set<std::uint32_t>(particles.begin(), particles.end()).size(), 70u);
  EXPECT_EQ(edges.size(), elements.edges().size());
  EXPECT_EQ(std::set<std::uint32_t>(edges.begin(), edges.end()).size(), edges.size());
  EXPECT_EQ(elements.vertices().size(), 70u);
  EXPECT_EQ(elements.particle_end(), 235u);
}

TEST(SurfaceElements, RopesAndGrains) {
  SurfaceElements elements;
  const Edge rope[] = {{0, 1}, {1, 2}, {2, 2}};
  elements.add_edges(rope, 10, 3);
  elements.add_particles(20, 25, 4);
  ASSERT_EQ(elements.elements().size(), 7u);
  EXPECT_EQ(elements.elements()[1].corners, 2);
  EXPECT_EQ(elements.elements()[1].particle[2], 12u);
  EXPECT_EQ(elements.elements()[1].owns_particle, 2);
  EXPECT_EQ(elements.elements()[6].corners, 1);
  EXPECT_EQ(elements.elements()[6].particle[1], 24u);
  EXPECT_EQ(elements.edges().size(), 2u);
  EXPECT_EQ(elements.vertices().size(), 8u);
  EXPECT_TRUE(elements.triangles().empty());
  elements.clear();
  EXPECT_TRUE(elements.elements().empty());
  EXPECT_EQ(elements.particle_end(), 0u);
}

TEST(SurfaceElements, ATriangleWithARepeatedCornerIsLeftOut) {
  SurfaceElements elements;
  const Triangle triangles[] = {{0, 1, 1}, {0, 1, 2}};
  elements.add_triangles(triangles, 0, 0);
  EXPECT_EQ(elements.elements().size(), 1u);
  EXPECT_EQ(elements.edges().size(), 3u);
}

}  // namespace souple::test_broad_phase_spatial_hash
