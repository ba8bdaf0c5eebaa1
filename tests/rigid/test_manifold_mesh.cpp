#include "souple/geometry/builders.h"
#include "tests/rigid/convex_pairs.h"

#include <set>

#include <gtest/gtest.h>

namespace souple::test_rigid_manifold_mesh {

constexpr double pi = std::numbers::pi;
constexpr double margin = 0.1;

BodyPose at(double x, double y, double z) {
  return {{x, y, z}, {}};
}

void expect_vector(const Vec3d& v, const Vec3d& expected, double tolerance = 1e-9) {
  EXPECT_NEAR(v.x, expected.x, tolerance);
  EXPECT_NEAR(v.y, expected.y, tolerance);
  EXPECT_NEAR(v.z, expected.z, tolerance);
}

TEST(PlaneManifold, HoldsAllShapesAtTheirLowestPoints) {
  const Plane floor{{0, 2, 0}, 2};  // y <= 1, with a normal of length 2
  test::Random random(1);
  for (int i = 0; i < 1000; ++i) {
    const ConvexShape a = test::random_shape(random, 1);
    BodyPose pose = test::random_pose(random, 1);
    const double depth = random.uniform(-0.09, 0.3);
    pose.position.y += 1 - depth + test::reach(a, pose, {0, -1, 0});
    const Manifold m = find_manifold(a, pose, floor, {}, margin);
    ASSERT_GT(m.count, 0);
    EXPECT_EQ(m.normal, (Vec3d{0, 1, 0}));
    EXPECT_NEAR(test::least_separation(m), -depth, 1e-4);
    for (std::size_t k = 0; k < static_cast<std::size_t>(m.count); ++k) {
      const Vec3d on_a = pose.point(m.points[k].on_a);
      EXPECT_NEAR(on_a.y - 1, m.points[k].separation, 1e-9);
      expect_vector(m.points[k].on_b, {on_a.x, 1, on_a.z});
    }
    pose.position.y += depth + margin * 1.001;
    EXPECT_EQ(find_manifold(a, pose, floor, {}, margin).count, 0);
  }
}

TEST(PlaneManifold, ABoxStandsOnItsFourCornersOnATiltedMovingPlane) {
  const BodyPose slope{{3, -1, 2}, Quatd::from_axis_angle({0, 0, 1}, 0.5)};
  const BodyPose box{slope.point({0.2, 0.49, 0.1}), slope.rotation};
  const Manifold m = find_manifold(convex_box({0.5, 0.5, 0.5}), box, Plane{}, slope, margin);
  ASSERT_EQ(m.count, 4);
  expect_vector(m.normal, slope.direction({0, 1, 0}));
  for (const ManifoldPoint& p : m.points) {
    EXPECT_NEAR(p.separation, -0.01, 1e-9);
    EXPECT_NEAR(std::abs(p.on_a.x), 0.5, 1e-12);
    EXPECT_NEAR(p.on_b.y, 0, 1e-12);
  }
}

TEST(PlaneManifold, ManyVerticesGiveFourPointsThatHoldTheBody) {
  const ConvexShape cylinder = convex_cylinder(0.5, 0.2, 300);
  const Manifold m = find_manifold(cylinder, at(0, 0.19, 0), Plane{}, {}, 0.05);
  ASSERT_EQ(m.count, 4);
  Vec3d sum{};
  for (const ManifoldPoint& p : m.points) sum += p.on_b / 4.0;
  EXPECT_LT(std::hypot(sum.x, sum.z), 0.15);
}

/// A triangle in the plane y = 0 that pushes up.
ContactTriangle floor_triangle() {
  return {{{{-2, 0, -2}, {0, 0, 2}, {2, 0, -2}}}};
}

Manifold on_triangle(const ConvexShape& a, const BodyPose& pose, const ContactTriangle& b) {
  AxisCache cache;
  return find_manifold(a, pose, b, {}, margin, cache);
}

TEST(TriangleManifold, HoldsABoxASphereAndACapsule) {
  const Manifold box = on_triangle(convex_box({0.3, 0.3, 0.3}), at(0, 0.29, -1), floor_triangle());
  ASSERT_EQ(box.count, 4);
  expect_vector(box.normal, {0, 1, 0});
  for (const ManifoldPoint& p : box.points) EXPECT_NEAR(p.separation, -0.01, 1e-9);
  const Manifold sphere = on_triangle(convex_sphere(0.3), at(0, 0.35, -1), floor_triangle());
  ASSERT_EQ(sphere.count, 1);
  EXPECT_NEAR(sphere.points[0].separation, 0.05, 1e-9);
  expect_vector(sphere.points[0].on_b, {0, 0, -1});
  const BodyPose lying{{0, 0.29, -1}, Quatd::from_axis_angle({0, 0, 1}, pi / 2)};
  const Manifold capsule = on_triangle(convex_capsule(0.3, 0.4), lying, floor_triangle());
  ASSERT_EQ(capsule.count, 2);
  EXPECT_NEAR(capsule.points[0].separation, -0.01, 1e-9);
}

TEST(TriangleManifold, PushesToItsNormalsSideOnly) {
  const ConvexShape box = convex_box({0.3, 0.3, 0.3});
  for (const double height : {0.25, 0.1, 0.01}) {
    const Manifold m = on_triangle(box, at(0, height, -1), floor_triangle());
    ASSERT_GT(m.count, 0);
    expect_vector(m.normal, {0, 1, 0});
    EXPECT_NEAR(test::least_separation(m), height - 0.3, 1e-9);
  }
  EXPECT_EQ(on_triangle(box, at(0, -0.01, -1), floor_triangle()).count, 0);
  ContactTriangle sheet = floor_triangle();
  sheet.double_sided = true;
  const Manifold below = on_triangle(box, at(0, -0.25, -1), sheet);
  ASSERT_EQ(below.count, 4);
  expect_vector(below.normal, {0, -1, 0});
  EXPECT_NEAR(test::least_separation(below), -0.05, 1e-9);
}

TEST(TriangleManifold, AtABorderASphereIsPushedAside) {
  const double d = 0.2;
  const Manifold m = on_triangle(convex_sphere(0.3), at(0, d, -2 - d), floor_triangle());
  ASSERT_EQ(m.count, 1);
  expect_vector(m.normal, normalized(Vec3d{0, 1, -1}));
  EXPECT_NEAR(m.points[0].separation, std::sqrt(2) * d - 0.3, 1e-9);
  ContactTriangle inner = floor_triangle();
  inner.lean = {0, 0, 0};
  EXPECT_EQ(on_triangle(convex_sphere(0.3), at(0, d, -2 - d), inner).count, 0);  // the neighbor's
}

TEST(TriangleManifold, WithoutAreaItHasNoContact) {
  EXPECT_EQ(on_triangle(convex_sphere(1), at(0, 0, 0), {{{{-1, 0, 0}, {0, 0, 0}, {1, 0, 0}}}}).count, 0);
  EXPECT_EQ(on_triangle(convex_sphere(1), at(0, 0, 0), {}).count, 0);
}

/// A mesh's triangles with their leans.
std::vector<ContactTriangle> contact_triangles(const std::vector<Vec3d>& x,
                                               const std::vector<Triangle>& triangles) {
  const auto leans = edge_leans(x, triangles);
  std::vector<ContactTriangle> out;
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    out.push_back({{x[triangles[t][0]], x[triangles[t][1]], x[triangles[t][2]]}, leans[t]});
  }
  return out;
}

/// A square of many triangles, columns x columns, at heights given by a function of x.
template <class Height>
std::vector<ContactTriangle> terrain(int columns, double size, const Height& height) {
  std::vector<Vec3d> x;
  std::vector<Triangle> triangles;
  for (int i = 0; i <= columns; ++i) {
    for (int j = 0; j <= columns; ++j) {
      const double u = size * (static_cast<double>(i) / columns - 0.5),
                   v = size * (static_cast<double>(j) / columns - 0.5);
      x.push_back({u, height(u), v});
      if (i == columns || j == columns) continue;
      const auto a = static_cast<std::uint32_t>(i * (columns + 1) + j),
                 b = a + static_cast<std::uint32_t>(columns) + 1;
      triangles.push_back({a, a + 1, b});
      triangles.push_back({b, a + 1, b + 1});
    }
  }
  return contact_triangles(x, triangles);
}

TEST(TriangleManifold, ABoxSlidesOverInnerEdgesOfAFlatMeshWithoutAPushAside) {
  const std::vector<ContactTriangle> floor = terrain(10, 5, [](double) { return 0.0; });
  test::Random random(2);
  for (int i = 0; i < 500; ++i) {
    const ConvexShape a = i % 4 == 0 ? convex_capsule(0.2, 0.3) : convex_box({0.3, 0.2, 0.4});
    const double tilt = i % 2 == 0 ? 0 : 0.02;
    BodyPose pose{{random.uniform(-1, 1), 0, random.uniform(-1, 1)},
                  Quatd::from_axis_angle(test::random_unit(random), tilt) *
                      Quatd::from_axis_angle({0, 1, 0}, random.uniform(0, 6))};
    pose.position.y = test::reach(a, pose, {0, -1, 0}) - random.uniform(-0.01, 0.02);
    int points = 0;
    for (const ContactTriangle& t : floor) {
      const Manifold m = on_triangle(a, pose, t);
      points += m.count;
      if (m.count > 0) {
        ASSERT_GT(m.normal.y, 1 - 1e-9) << i;
      }
    }
    ASSERT_GT(points, 0) << i;
  }
}

TEST(TriangleManifold, OnARidgeNormalsLieBetweenThoseOfItsSides) {
  const double slope = 0.3, angle = std::atan(slope);
  const std::vector<ContactTriangle> ridge = terrain(4, 4, [&](double x) { return -slope * std::abs(x); });
  const ConvexShape box = convex_box({0.3, 0.2, 0.4});
  test::Random random(3);
  int points = 0;
  for (int i = 0; i < 500; ++i) {
    BodyPose pose{{random.uniform(-0.3, 0.3), 0, random.uniform(-0.5, 0.5)},
                  Quatd::from_axis_angle({0, 1, 0}, random.uniform(0, 6))};
    pose.position.y = 0.2 - random.uniform(0, 0.02);
    for (const ContactTriangle& t : ridge) {
      const Manifold m = on_triangle(box, pose, t);
      points += m.count;
      if (m.count == 0) continue;
      ASSERT_GT(m.normal.y, std::cos(angle) - 1e-6) << i;
      ASSERT_NEAR(m.normal.z, 0, 1e-6) << i;
    }
  }
  EXPECT_GT(points, 500);
}

std::vector<std::uint32_t> numbers(std::size_t count) {
  std::vector<std::uint32_t> out(count);
  for (std::size_t i = 0; i < count; ++i) out[i] = static_cast<std::uint32_t>(i);
  return out;
}

TEST(MeshManifold, ABoxOnManyTrianglesHasFourPointsThatPersistWhenItSlides) {
  const std::vector<ContactTriangle> floor = terrain(20, 5, [](double) { return 0.0; });
  const std::vector<std::uint32_t> names = numbers(floor.size());
  const ConvexShape box = convex_box({0.3, 0.2, 0.4});
  std::set<std::uint32_t> first;
  for (int i = 0; i < 100; ++i) {
    std::array<Manifold, 8> found;
    const BodyPose pose{{-0.5 + 0.01 * i, 0.199 + 1e-6 * std::sin(i), 0.003 * i},
                        Quatd::from_axis_angle({0, 1, 0}, 0.3)};
    ASSERT_EQ(find_manifolds(box, pose, floor, names, {}, margin, found), 1) << i;
    ASSERT_EQ(found[0].count, 4) << i;
    std::set<std::uint32_t> features;
    for (const ManifoldPoint& p : found[0].points) {
      features.insert(p.feature);
      ASSERT_NEAR(p.separation, -0.001, 1e-5);
      ASSERT_NEAR(std::abs(p.on_a.x), 0.3, 1e-9);
      ASSERT_NEAR(std::abs(p.on_a.z), 0.4, 1e-9);
      ASSERT_NEAR(p.on_b.y, 0, 1e-9);
    }
    if (i == 0) first = features;
    ASSERT_EQ(features, first) << i;
  }
}

TEST(MeshManifold, InACornerThereIsOneOfTheFloorAndOneOfTheWall) {
  // The wall begins at x = 0.
  const std::vector<ContactTriangle> bent = terrain(10, 5, [](double x) { return x > 0 ? 8 * x : 0.0; });
  const std::vector<std::uint32_t> names = numbers(bent.size());
  const Vec3d wall = normalized(Vec3d{-8, 1, 0});
  const ConvexShape ball = convex_sphere(0.2);
  std::array<Manifold, 8> found;
  // At 0.19 from the floor and from the wall.
  const double x = -0.19 * (1 - wall.y) / -wall.x;
  ASSERT_EQ(find_manifolds(ball, at(x, 0.19, 0.1), bent, names, {}, margin, found), 2);
  for (int m = 0; m < 2; ++m) {
    ASSERT_EQ(found[static_cast<std::size_t>(m)].count, 1);
    EXPECT_NEAR(found[static_cast<std::size_t>(m)].points[0].separation, -0.01, 1e-9);
  }
  expect_vector(found[0].normal + found[1].normal, wall + Vec3d{0, 1, 0});
}

TEST(TriangleManifold, LeansOfABoxAreThoseOfRightAnglesAndOfAPitAreZero) {
  const std::vector<Vec3d> x{{0, 0, 0}, {0, 0, 1}, {1, 0, 0}, {0, -1, 0}, {0, 1, 0}};
  const auto falling = edge_leans(x, std::vector<Triangle>{{0, 1, 2}, {1, 0, 3}});
  EXPECT_NEAR(falling[0][0], 1, 1e-12);
  EXPECT_NEAR(falling[0][1], 1, 1e-12);
  const auto rising = edge_leans(x, std::vector<Triangle>{{0, 1, 2}, {1, 0, 4}});
  EXPECT_NEAR(rising[0][0], 0, 1e-12);
  EXPECT_NEAR(rising[1][0], 0, 1e-12);
}

TEST(TriangleManifold, OfRandomPairsIsThatOfATruthByProjection) {
  // A free triangle is a convex shape: where it pushes up, its depth is the least one of the upper half of all axes.
  test::Random random(4);
  int touching = 0;
  for (int i = 0; i < 3000; ++i) {
    const ConvexShape a = test::random_shape(random, 0.5);
    BodyPose pose = test::random_pose(random, 0.8);
    const ContactTriangle t = floor_triangle();
    Manifold m = on_triangle(a, pose, t);
    if (m.count == 0) continue;
    ASSERT_GE(m.normal.y, -1e-6);
    ++touching;
    const double separation = test::least_separation(m);
    pose.position -= m.normal * separation;
    const double tolerance = 2e-3 * a.outer_radius;
    double nearest = -1e9;
    for (int j = 0; j < 300; ++j) {
      const Vec3d n = j == 0 ? m.normal : test::random_unit(random);
      const double on_b = std::max({dot(n, t.corners[0]), dot(n, t.corners[1]), dot(n, t.corners[2])});
      const double along = -test::reach(a, pose, -n) - on_b;
      nearest = std::max(nearest, along);
      ASSERT_LE(along, tolerance) << i << " separation " << separation << " count " << m.count;
    }
  }
  EXPECT_GT(touching, 1000);
}

TEST(FieldManifold, ABoxOnTheShapeOfAColliderTouchesWithItsVertices) {
  const ConvexShape box = convex_box({0.3, 0.3, 0.3});
  std::array<Manifold, 4> found;
  const Shape floor = Box{.half_extents = {2, 1, 2}};
  ASSERT_EQ(find_manifolds(box, at(0, 1.29, 0), floor, {}, margin, found), 1);
  ASSERT_EQ(found[0].count, 4);
  expect_vector(found[0].normal, {0, 1, 0});
  for (const ManifoldPoint& p : found[0].points) EXPECT_NEAR(p.separation, -0.01, 1e-9);
  EXPECT_EQ(find_manifolds(box, at(0, 1.5, 0), floor, {}, margin, found), 0);
}

TEST(FieldManifold, InAGrooveABoxHasAManifoldForEachSide) {
  // The inside of a hollow sphere: a field that is negative outside of radius 1.
  const ConvexShape box = convex_box({0.3, 0.3, 0.3});
  const ConvexShape ball = convex_sphere(0.2);
  std::array<Manifold, 4> found;
  ASSERT_EQ(find_manifolds(ball, at(0, 0.69, 0), Sphere{.radius = 0.5}, {}, margin, found), 1);
  expect_vector(found[0].normal, {0, 1, 0});
  EXPECT_NEAR(found[0].points[0].separation, -0.01, 1e-7);
  // A box around a thin post: vertices on two opposite sides.
  const int count = find_manifolds(box, at(0, 0, 0), Sphere{.radius = 0.51f}, {}, margin, found);
  EXPECT_EQ(count, 4);  // eight vertices in eight directions, at most four manifolds
}

}  // namespace souple::test_rigid_manifold_mesh
