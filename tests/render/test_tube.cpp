#include "render/tube.h"
#include "souple/geometry/adjacency.h"
#include "souple/geometry/measures.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <tuple>
#include <vector>

#include <gtest/gtest.h>

namespace souple::render::test_render_tube {

constexpr float pi = 3.14159265f;

Tube tube_of(const std::vector<Vec3f>& points, float radius) {
  float length = 0;
  for (std::size_t i = 0; i + 1 < points.size(); ++i) length += souple::length(points[i + 1] - points[i]);
  Tube tube;
  tube.resize(points.size(), radius, length);
  tube.update(points, radius);
  return tube;
}

std::vector<Vec3f> circle(std::size_t count, float radius, float turn) {
  std::vector<Vec3f> points;
  for (std::size_t i = 0; i < count; ++i) {
    const float a = turn * static_cast<float>(i) / static_cast<float>(count - 1);
    points.push_back({radius * std::cos(a), radius * std::sin(a), 0.3f * a});
  }
  return points;
}

/// The triangles after merging vertices at equal positions.
std::vector<Triangle> welded(const Tube& tube) {
  std::map<std::tuple<float, float, float>, std::uint32_t> first;
  std::vector<Triangle> result;
  for (const Triangle& t : tube.triangles()) {
    Triangle corners{};
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3f& x = tube.positions()[t[k]];
      corners[k] = first.try_emplace({x.x, x.y, x.z}, t[k]).first->second;
    }
    result.push_back(corners);
  }
  return result;
}

double distance_to_polyline(const Vec3f& point, const std::vector<Vec3f>& line) {
  double best = std::numeric_limits<double>::infinity();
  const Vec3d p(point);
  for (std::size_t i = 0; i + 1 < line.size(); ++i) {
    const Vec3d a(line[i]), d = Vec3d(line[i + 1]) - a;
    const double t = std::clamp(dot(p - a, d) / dot(d, d), 0.0, 1.0);
    best = std::min(best, length(p - a - d * t));
  }
  return best;
}

void expect_valid(const Tube& tube) {
  for (const Vec3f& x : tube.positions()) ASSERT_TRUE(is_finite(x));
  for (const Vec3f& n : tube.normals()) ASSERT_NEAR(length(n), 1, 1e-4);
  for (const Triangle& t : tube.triangles())
    for (const std::uint32_t v : t) ASSERT_LT(v, tube.positions().size());
}

TEST(Tube, ItsSkinLiesAtTheRadiusFromASmoothRope) {
  const float radius = 0.03f;
  const std::vector<Vec3f> rope = circle(25, 0.5f, 4.0f);
  const Tube tube = tube_of(rope, radius);
  expect_valid(tube);
  // Chords of the polyline shorten the arc by 0.5 (1 - cos(step / 2)): compared with the true helix.
  const std::vector<Vec3f> exact = circle(4001, 0.5f, 4.0f);
  for (const Vec3f& x : tube.positions()) ASSERT_NEAR(distance_to_polyline(x, exact), radius, 0.01 * radius);
}

TEST(Tube, IsClosedWatertightAndWoundOutward) {
  const float radius = 0.02f;
  std::vector<Vec3f> straight;
  for (int i = 0; i <= 10; ++i) straight.push_back({0.1f * static_cast<float>(i), 0, 0});
  for (const auto& rope : {straight, circle(25, 0.5f, 4.0f)}) {
    const Tube tube = tube_of(rope, radius);
    EXPECT_TRUE(boundary_edges(welded(tube)).empty());
    std::vector<Vec3d> x;
    for (const Vec3f& p : tube.positions()) x.emplace_back(p);
    float length = 0;
    for (std::size_t i = 0; i + 1 < rope.size(); ++i) length += souple::length(rope[i + 1] - rope[i]);
    const double expected = static_cast<double>(pi * radius * radius * (length + 4.0f / 3 * radius));
    EXPECT_NEAR(enclosed_volume(x, tube.triangles()), expected, 0.04 * expected);
    for (const Triangle& t : tube.triangles()) {
      const Vec3d face = cross(x[t[1]] - x[t[0]], x[t[2]] - x[t[0]]);
      EXPECT_GT(dot(face, Vec3d(tube.normals()[t[0]])), -1e-12);
    }
  }
}

TEST(Tube, CapsAreHalfBalls) {
  const float radius = 0.1f;
  const Tube tube = tube_of({{0, 0, 0}, {1, 0, 0}}, radius);
  float lo = 0, hi = 0;
  for (const Vec3f& x : tube.positions()) {
    lo = std::min(lo, x.x);
    hi = std::max(hi, x.x);
    if (x.x < 0) {
      EXPECT_NEAR(length(x), radius, 1e-5);
    }
  }
  EXPECT_NEAR(lo, -radius, 1e-6);
  EXPECT_NEAR(hi, 1 + radius, 1e-6);
}

TEST(Tube, PointsThatCoincideAreSafe) {
  const Vec3f a{0.3f, 1, -2}, b{0.5f, 1, -2};
  for (const std::vector<Vec3f>& rope : std::vector<std::vector<Vec3f>>{
           {a}, {a, a}, {a, a, a, a}, {a, a, b, b}, {a, b, b, a}, {a, b, a, b}, {b, b, b, a}}) {
    const Tube tube = tube_of(rope, 0.02f);
    expect_valid(tube);
    for (const Vec3f& x : tube.positions()) EXPECT_LT(distance_to_polyline(x, {a, b, a}), 0.06);
  }
}

TEST(Tube, DoesNotTwistAboutItself) {
  // In a planar bend, the direction perpendicular to the plane stays unchanged.
  std::vector<Vec3f> rope;
  for (int i = 0; i <= 20; ++i) {
    const float angle = 0.15f * static_cast<float>(i);
    rope.push_back({std::cos(angle), std::sin(angle), 0});
  }
  const Tube tube = tube_of(rope, 0.05f);
  const std::size_t row = Tube::sides + 1, first = 1 + 5 * row, last = tube.positions().size() - 1 - 6 * row;
  for (std::size_t s = 0; s < row; ++s)
    EXPECT_NEAR(tube.normals()[first + s].z, tube.normals()[last + s].z, 1e-3) << s;
}

TEST(Tube, TellsWhichPointAVertexBelongsTo) {
  const std::vector<Vec3f> rope = circle(25, 0.5f, 4.0f);
  const Tube tube = tube_of(rope, 0.01f);
  EXPECT_EQ(tube.point_of(0), 0u);
  EXPECT_EQ(tube.point_of(tube.positions().size() - 1), 24u);
  for (std::size_t v = 0; v < tube.positions().size(); ++v) {
    std::size_t nearest = 0;
    for (std::size_t i = 0; i < rope.size(); ++i)
      if (length(tube.positions()[v] - rope[i]) < length(tube.positions()[v] - rope[nearest])) nearest = i;
    const std::uint32_t said = tube.point_of(v);
    EXPECT_LE(length(tube.positions()[v] - rope[said]), 1.2f * length(tube.positions()[v] - rope[nearest]));
  }
}

}  // namespace souple::render::test_render_tube
