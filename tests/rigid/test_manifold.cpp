#include "souple/error.h"
#include "souple/geometry/builders.h"
#include "souple/rigid/convex_shape.h"
#include "souple/rigid/mesh_shape.h"
#include "tests/rigid/convex_pairs.h"

#include <cmath>
#include <limits>
#include <set>

#include <gtest/gtest.h>

namespace souple::test_rigid_manifold {

/// Volume of the polyhedron by the pyramids from the origin to its faces.
double volume(const ConvexShape& shape) {
  double sum = 0;
  for (const ConvexFace& f : shape.faces) {
    const Vec3d a = shape.vertices[shape.corners[f.begin].vertex];
    for (std::uint32_t c = f.begin + 1; c + 1 < f.end; ++c) {
      sum += dot(a, cross(shape.vertices[shape.corners[c].vertex],
                          shape.vertices[shape.corners[c + 1].vertex])) /
             6;
    }
  }
  return sum;
}

TEST(ConvexShape, ABoxHasSixFacesTwelveEdgesAndItsVolume) {
  const ConvexShape box = convex_box({0.5, 1, 2});
  EXPECT_EQ(box.vertices.size(), 8u);
  EXPECT_EQ(box.faces.size(), 6u);
  EXPECT_EQ(box.edges.size(), 12u);
  EXPECT_NEAR(volume(box), 8, 1e-12);
  EXPECT_NEAR(box.inner_radius, 0.5, 1e-12);
  EXPECT_NEAR(box.outer_radius, std::sqrt(0.25 + 1 + 4), 1e-12);
  EXPECT_EQ(box.bounds.hi, (Vec3d{0.5, 1, 2}));
}

TEST(ConvexShape, ACylinderIsAPrismWithItsVerticesOnTheRims) {
  const ConvexShape cylinder = convex_cylinder(0.5, 1, 24);
  EXPECT_EQ(cylinder.faces.size(), 26u);
  EXPECT_EQ(cylinder.edges.size(), 72u);
  EXPECT_NEAR(volume(cylinder), 2 * 0.5 * 0.5 * 12 * std::sin(2 * 3.14159265358979 / 24), 1e-9);
  for (const Vec3d& v : cylinder.vertices) EXPECT_NEAR(std::hypot(v.x, v.z), 0.5, 1e-12);
}

TEST(ConvexShape, NormalsEdgesAndSidePlanesFitTogether) {
  for (const ConvexShape& s : {convex_box({1, 2, 3}), convex_cylinder(1, 2, 7), convex_cylinder(1, 1, 200)}) {
    for (const ConvexFace& f : s.faces) {
      EXPECT_NEAR(length(f.normal), 1, 1e-12);
      EXPECT_LE(f.end - f.begin, max_face_corners);
      for (std::uint32_t c = f.begin; c < f.end; ++c) {
        EXPECT_NEAR(dot(f.normal, s.corners[c].side_normal), 0, 1e-12);
        // The face lies on the inner side of its side planes.
        for (std::uint32_t d = f.begin; d < f.end; ++d) {
          EXPECT_LE(dot(s.corners[c].side_normal, s.vertices[s.corners[d].vertex]),
                    s.corners[c].side_offset + 1e-12);
        }
      }
    }
    for (const ConvexEdge& e : s.edges) {
      EXPECT_NEAR(dot(s.faces[e.left].normal, s.vertices[e.from]), s.faces[e.left].offset, 1e-12);
      EXPECT_NEAR(dot(s.faces[e.right].normal, s.vertices[e.to]), s.faces[e.right].offset, 1e-12);
      const Vec3d around = cross(s.faces[e.left].normal, s.faces[e.right].normal);
      EXPECT_GT(dot(around, s.vertices[e.to] - s.vertices[e.from]), 0);
    }
  }
}

TEST(ConvexShape, TheHullOfABoxesCornersEdgesAndInsideIsTheBox) {
  std::vector<Vec3d> points;
  for (const double x : {-1, 0, 1}) {
    for (const double y : {-1, 0, 1}) points.insert(points.end(), {{x, y, -2}, {x, y, 0}, {x, y, 2}});
  }
  const ConvexShape hull = convex_polyhedron(convex_hull(points), 0.1);
  EXPECT_EQ(hull.vertices.size(), 8u);
  EXPECT_EQ(hull.faces.size(), 6u);
  EXPECT_EQ(hull.edges.size(), 12u);
  EXPECT_NEAR(volume(hull), 16, 1e-9);
  EXPECT_NEAR(hull.inner_radius, 1, 1e-9);
  EXPECT_LT(length(hull.bounds.hi - Vec3d{1.1, 1.1, 2.1}), 1e-9);
  EXPECT_THROW(convex_hull(std::vector<Vec3d>{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}}), Error);
}

TEST(ConvexShape, MovesAsAWhole) {
  const BodyPose pose{{1, -2, 3}, normalized(Quatd{0.1, 0.7, -0.3, 0.5})};
  const ConvexShape shape = convex_cylinder(0.5, 1, 12), there = moved(shape, pose);
  EXPECT_NEAR(there.inner_radius, shape.inner_radius, 1e-12);
  for (const ConvexFace& f : there.faces) {
    for (std::uint32_t c = f.begin; c < f.end; ++c) {
      EXPECT_NEAR(dot(f.normal, there.vertices[there.corners[c].vertex]), f.offset, 1e-12);
      EXPECT_NEAR(dot(there.corners[c].side_normal, there.vertices[there.corners[c].vertex]),
                  there.corners[c].side_offset, 1e-12);
    }
  }
}

TEST(ConvexShape, OfACollidersShapeHasItsPlace) {
  const std::optional<ConvexShape> box =
      convex_shape_of(Box{.center = {1, 2, 3}, .half_extents = {0.5f, 1, 2}});
  ASSERT_TRUE(box.has_value());
  EXPECT_LT(length(box->bounds.lo - Vec3d{0.5, 1, 1}), 1e-6);
  EXPECT_TRUE(convex_shape_of(Capsule{}).has_value());
  EXPECT_FALSE(convex_shape_of(Plane{}).has_value());
}

TEST(ConvexShape, RefusesSizesAndFacesThatMakeNoBody) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(convex_sphere(0), Error);
  EXPECT_THROW(convex_sphere(nan), Error);
  EXPECT_THROW(convex_capsule(1, -1), Error);
  EXPECT_THROW(convex_box({1, 0, 1}), Error);
  EXPECT_THROW(convex_cylinder(1, 1, 2), Error);
  const ConvexShape box = convex_box({1, 1, 1});
  std::vector<FaceLoop> faces{{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 2, 3, 1}};
  EXPECT_THROW(convex_polyhedron(box.vertices, faces), Error);  // open
  faces.push_back({4, 5, 7, 8});
  EXPECT_THROW(convex_polyhedron(box.vertices, faces), Error);  // no such vertex
  faces.back() = {4, 6, 7, 5};
  EXPECT_THROW(convex_polyhedron(box.vertices, faces), Error);  // wound the wrong way
  faces.back() = {4, 5, 7, 6};
  EXPECT_NO_THROW(convex_polyhedron(box.vertices, faces));
  std::vector<Vec3d> dented = box.vertices;
  dented[7] = {0.1, 0.1, 0.1};
  EXPECT_THROW(convex_polyhedron(dented, faces), Error);
}

constexpr double pi = std::numbers::pi;
constexpr double margin = 0.1;

BodyPose at(double x, double y, double z) {
  return {{x, y, z}, {}};
}
BodyPose turned(const Vec3d& position, const Vec3d& axis, double angle) {
  return {position, Quatd::from_axis_angle(normalized(axis), angle)};
}

void expect_vector(const Vec3d& v, const Vec3d& expected, double tolerance = 1e-9) {
  EXPECT_NEAR(v.x, expected.x, tolerance);
  EXPECT_NEAR(v.y, expected.y, tolerance);
  EXPECT_NEAR(v.z, expected.z, tolerance);
}

/// All four separations are `separation`, and the points span an area [m^2] perpendicular to y.
void expect_flat(const Manifold& m, double separation, double area) {
  ASSERT_EQ(m.count, 4);
  std::vector<Vec3d> x;
  for (const ManifoldPoint& p : m.points) {
    EXPECT_NEAR(p.separation, separation, 1e-9);
    x.push_back(p.on_a);
  }
  const Vec3d center = (x[0] + x[1] + x[2] + x[3]) / 4.0;
  const auto angle = [&](const Vec3d& p) { return std::atan2(p.z - center.z, p.x - center.x); };
  std::sort(x.begin(), x.end(), [&](const Vec3d& p, const Vec3d& q) { return angle(p) < angle(q); });
  EXPECT_NEAR(length(cross(x[2] - x[0], x[3] - x[1])) / 2, area, 1e-9);
}

/// The manifold of a body and one at the origin.
Manifold on_origin(const ConvexShape& a, const BodyPose& pose, const ConvexShape& b) {
  return test::find_fresh(a, pose, b, {}, margin);
}

std::set<std::uint32_t> features(const Manifold& m) {
  std::set<std::uint32_t> out;
  for (std::size_t k = 0; k < static_cast<std::size_t>(m.count); ++k) out.insert(m.points[k].feature);
  return out;
}

TEST(BoxManifold, ABoxOnABoxHasFourPointsOfEqualDepth) {
  const ConvexShape small = convex_box({0.5, 0.5, 0.5}), large = convex_box({2, 1, 2});
  const Manifold m = on_origin(small, turned({0.3, 1.49, -0.2}, {0, 1, 0}, 0.4), large);
  expect_vector(m.normal, {0, 1, 0});
  expect_flat(m, -0.01, 1);
  EXPECT_EQ(features(m).size(), 4u);
  for (std::size_t k = 0; k < 4; ++k) {
    expect_vector({std::abs(m.points[k].on_a.x), m.points[k].on_a.y, std::abs(m.points[k].on_a.z)},
                  {0.5, -0.5, 0.5});
    EXPECT_NEAR(m.points[k].on_b.y, 1, 1e-12);
  }
}

TEST(BoxManifold, BoxesThatOverlapInPartTouchInTheOverlap) {
  const ConvexShape box = convex_box({0.5, 0.5, 0.5});
  const Manifold m = on_origin(box, at(0.7, 1.02, 0.4), box);
  expect_vector(m.normal, {0, 1, 0});
  expect_flat(m, 0.02, 0.3 * 0.6);
}

TEST(BoxManifold, OctagonsKeepFourPointsThatSpanThem) {
  const ConvexShape box = convex_box({0.5, 0.5, 0.5});
  const Manifold m = on_origin(box, turned({0, 0.999, 0}, {0, 1, 0}, pi / 4), box);
  ASSERT_EQ(m.count, 4);
  Vec3d sum{};
  for (std::size_t k = 0; k < 4; ++k) sum += m.points[k].on_b;
  EXPECT_LT(std::hypot(sum.x, sum.z) / 4, 0.11);  // the body's weight is within
}

TEST(BoxManifold, AnEdgeOnAFaceHasTwoPoints) {
  const ConvexShape box = convex_box({0.5, 0.5, 0.5}), floor = convex_box({5, 1, 5});
  const double height = 1 + std::sqrt(0.5) - 0.02;
  const Manifold m = on_origin(box, turned({0, height, 0}, {0, 0, 1}, pi / 4), floor);
  ASSERT_EQ(m.count, 2);
  expect_vector(m.normal, {0, 1, 0});
  for (std::size_t k = 0; k < 2; ++k) {
    EXPECT_NEAR(m.points[k].separation, -0.02, 1e-9);
    EXPECT_NEAR(std::abs(m.points[k].on_b.z), 0.5, 1e-9);
  }
}

TEST(BoxManifold, ACornerOnAFaceHasOnePoint) {
  const ConvexShape box = convex_box({0.5, 0.5, 0.5}), floor = convex_box({5, 1, 5});
  const Quatd corner_down = Quatd::from_axis_angle({1, 0, 0}, std::atan(std::sqrt(0.5))) *
                            Quatd::from_axis_angle({0, 0, 1}, pi / 4);
  for (const double depth : {0.03, -0.03}) {
    const BodyPose pose{{0, 1 + std::sqrt(0.75) - depth, 0}, corner_down};
    const Manifold m = on_origin(box, pose, floor);
    ASSERT_EQ(m.count, 1);
    expect_vector(m.normal, {0, 1, 0});
    EXPECT_NEAR(m.points[0].separation, -depth, 1e-9);
    expect_vector(m.points[0].on_b, {0, 1, 0});
  }
}

TEST(BoxManifold, CrossedEdgesTouchInOnePoint) {
  const ConvexShape box = convex_box({0.5, 0.5, 0.5});
  for (const double depth : {0.05, -0.05}) {
    const BodyPose below = turned({0, 0, 0}, {0, 0, 1}, pi / 4);  // an edge along z on top
    const BodyPose above =
        turned({0.1, 2 * std::sqrt(0.5) - depth, 0.2}, {1, 0, 0}, pi / 4);  // and one along x below
    const Manifold m = test::find_fresh(box, above, box, below, margin);
    ASSERT_EQ(m.count, 1);
    expect_vector(m.normal, {0, 1, 0});
    EXPECT_EQ(m.owner, NormalOwner::edges);
    EXPECT_NEAR(m.points[0].separation, -depth, 1e-9);
    expect_vector(below.point(m.points[0].on_b), {0, std::sqrt(0.5), 0.2});
    expect_vector(above.point(m.points[0].on_a), {0, std::sqrt(0.5) - depth, 0.2});
  }
}

TEST(BoxManifold, ApartAcrossACornerItHasTheDirectionOfTheClosestPoints) {
  const ConvexShape box = convex_box({0.5, 0.5, 0.5});
  const Vec3d gap{0.03, 0.04, 0.05};
  const Manifold m = on_origin(box, {Vec3d{1, 1, 1} + gap, {}}, box);
  ASSERT_EQ(m.count, 1);
  expect_vector(m.normal, normalized(gap));
  EXPECT_NEAR(m.points[0].separation, length(gap), 1e-12);
  expect_vector(m.points[0].on_b, {0.5, 0.5, 0.5});
  expect_vector(m.points[0].on_a, {-0.5, -0.5, -0.5});
  EXPECT_EQ(on_origin(box, {Vec3d{1, 1, 1} + gap * 1.5, {}}, box).count, 0);
}

TEST(BoxManifold, TheLastAxisOfAFaceIsKeptWithinTheTolerance) {
  // The corner region, where two faces of b give nearly the same depth.
  const ConvexShape box = convex_box({0.5, 0.5, 0.5});
  const double tolerance = axis_tolerance(box, box);
  AxisCache cache;
  const auto normal_at = [&](double x, double y) {
    return find_manifold(box, at(x, y, 0), box, at(0, 0, 0), margin, cache).normal;
  };
  expect_vector(normal_at(0.9, 0.9 + tolerance), {0, 1, 0});
  expect_vector(normal_at(0.9 + 0.9 * tolerance, 0.9), {0, 1, 0});
  expect_vector(normal_at(0.9 + 1.1 * tolerance, 0.9), {1, 0, 0});
  expect_vector(normal_at(0.9, 0.9 + 0.9 * tolerance), {1, 0, 0});
}

TEST(BoxManifold, FeaturesPersistWhenABoxSlides) {
  const ConvexShape box = convex_box({0.5, 0.5, 0.5}), floor = convex_box({5, 1, 5});
  AxisCache cache;
  const auto found = [&](int i) {
    const BodyPose pose =
        turned({1e-3 * i, 1.5 + 1e-6 * std::sin(i), 0.5e-3 * i}, {0.001 * std::cos(i), 1, 0}, 1e-3 * i);
    return features(find_manifold(box, pose, floor, at(0, 0, 0), margin, cache));
  };
  const std::set<std::uint32_t> first = found(0);
  ASSERT_EQ(first.size(), 4u);
  for (int i = 1; i < 100; ++i) ASSERT_EQ(found(i), first) << i;
}

TEST(BoxManifold, FeaturesPersistInAStackOfEqualBoxesThatTrembles) {
  const ConvexShape box = convex_box({0.5, 0.5, 0.5});
  AxisCache cache;
  test::Random random(1);
  std::set<std::uint32_t> first;
  for (int i = 0; i < 200; ++i) {
    const Vec3d noise = random.point(-1e-5, 1e-5);
    const BodyPose pose = turned(Vec3d{0, 1, 0} + noise, random.point(-1, 1), random.uniform(0, 1e-5));
    const Manifold m = find_manifold(box, pose, box, at(0, 0, 0), margin, cache);
    if (i == 0) first = features(m);
    ASSERT_EQ(m.count, 4) << i;
    ASSERT_EQ(features(m), first) << i;
  }
}

TEST(BoxManifold, FeaturesPersistOnAnOctagonAndARimThatTremble) {
  const ConvexShape box = convex_box({0.5, 0.5, 0.5}), cylinder = convex_cylinder(0.5, 0.5, 24);
  test::Random random(2);
  for (const ConvexShape* shape : {&box, &cylinder}) {
    AxisCache cache;
    LastPoints points;
    std::set<std::uint32_t> first, first_on_plane;
    for (int i = 0; i < 200; ++i) {
      const Quatd yaw = Quatd::from_axis_angle({0, 1, 0}, 0.7);
      const BodyPose pose{Vec3d{0, 1, 0} + random.point(-1e-4, 1e-4),
                          Quatd::from_axis_angle(test::random_unit(random), 1e-4) * yaw};
      const auto on_box = features(find_manifold(*shape, pose, *shape, at(0, 0, 0), margin, cache));
      const auto on_plane = features(find_manifold(*shape, pose, Plane{.offset = 0.5f}, {}, margin, points));
      if (i == 0) first = on_box, first_on_plane = on_plane;
      ASSERT_EQ(on_box, first) << i;
      ASSERT_EQ(on_plane, first_on_plane) << i;
    }
    // Another side of the box or rim is deeper: then it is chosen.
    const BodyPose tilted = turned({0, 1, 0}, {1, 0, 0.3}, 0.01);
    const Manifold m = find_manifold(*shape, tilted, Plane{.offset = 0.5f}, {}, margin, points);
    EXPECT_NEAR(test::least_separation(m), -0.5 - (test::reach(*shape, tilted, {0, -1, 0})), 1e-3);
  }
}

TEST(BoxManifold, FeaturesAreTheSameWhicheverBoxIsTheReference) {
  const ConvexShape box = convex_box({0.5, 0.5, 0.5});
  const BodyPose below = at(0, 0, 0);
  // Tilted by 2e-3, the one or the other face gives the least penetration.
  const Manifold one = test::find_fresh(box, turned({0.3, 0.995, 0.2}, {0, 0, 1}, 2e-3), box, below, margin);
  const Manifold other =
      test::find_fresh(box, turned({0.3, 0.995, 0.2}, {0, 0, 1}, -2e-3), box, below, margin);
  EXPECT_NE(one.owner, other.owner);
  ASSERT_EQ(one.count, 4);
  EXPECT_EQ(features(one), features(other));
}

TEST(BoxManifold, ABoxInTheMiddleOfAnotherIsPushedOutTheShortestWay) {
  const ConvexShape box = convex_box({1, 0.2, 1}), small = convex_box({0.1, 0.1, 0.1});
  const Manifold m = on_origin(small, at(0.1, 0.02, 0.1), box);
  ASSERT_EQ(m.count, 4);
  expect_vector(m.normal, {0, 1, 0});
  EXPECT_NEAR(test::least_separation(m), -0.28, 1e-9);
  EXPECT_GT(on_origin(small, at(0, 0, 0), box).count, 0);
}

TEST(RoundManifold, OfTwoSpheres) {
  const ConvexShape a = convex_sphere(0.3), b = convex_sphere(0.5);
  for (const double gap : {-0.4, -0.01, 0.05}) {
    const Vec3d n = normalized(Vec3d{1, 2, -2});
    const Manifold m = on_origin(a, {n * (0.8 + gap), {}}, b);
    ASSERT_EQ(m.count, 1);
    expect_vector(m.normal, n);
    EXPECT_NEAR(m.points[0].separation, gap, 1e-12);
    expect_vector(m.points[0].on_b, n * 0.5);
    expect_vector(m.points[0].on_a, n * -0.3);
  }
  const Manifold same = on_origin(a, at(0, 0, 0), b);
  ASSERT_EQ(same.count, 1);
  EXPECT_NEAR(length(same.normal), 1, 1e-12);
  EXPECT_NEAR(same.points[0].separation, -0.8, 1e-12);
}

TEST(RoundManifold, OfASphereOnTheFaceEdgeAndCornerOfABox) {
  const ConvexShape sphere = convex_sphere(0.25), box = convex_box({0.5, 0.5, 0.5});
  for (const Vec3d outward : {Vec3d{0, 1, 0}, Vec3d{0, 1, 1}, Vec3d{-1, 1, 1}}) {
    for (const double gap : {-0.05, 0.05}) {
      const Vec3d n = normalized(outward), on_box = outward * 0.5;
      const Manifold m = on_origin(sphere, {on_box + n * (0.25 + gap), {}}, box);
      ASSERT_EQ(m.count, 1);
      expect_vector(m.normal, n);
      EXPECT_NEAR(m.points[0].separation, gap, 1e-9);
      expect_vector(m.points[0].on_b, on_box);
      expect_vector(m.points[0].on_a, n * -0.25);
    }
  }
  const Manifold inside = on_origin(sphere, at(0.1, 0.3, 0), box);
  ASSERT_EQ(inside.count, 1);
  expect_vector(inside.normal, {0, 1, 0});
  EXPECT_NEAR(inside.points[0].separation, -0.45, 1e-9);
}

TEST(RoundManifold, ACapsuleThatLiesOnAFaceHasTwoPointsAndUprightOne) {
  const ConvexShape capsule = convex_capsule(0.2, 0.6), box = convex_box({5, 0.5, 5});
  const Manifold lying = on_origin(capsule, turned({0, 0.69, 0}, {0, 0, 1}, pi / 2), box);
  ASSERT_EQ(lying.count, 2);
  expect_vector(lying.normal, {0, 1, 0});
  for (std::size_t k = 0; k < 2; ++k) {
    EXPECT_NEAR(lying.points[k].separation, -0.01, 1e-9);
    EXPECT_NEAR(std::abs(lying.points[k].on_b.x), 0.6, 1e-9);
  }
  const Manifold upright = on_origin(capsule, at(0, 1.29, 0), box);
  ASSERT_EQ(upright.count, 1);
  expect_vector(upright.normal, {0, 1, 0});
  EXPECT_NEAR(upright.points[0].separation, -0.01, 1e-9);
  // Beyond the face it is held by the part that lies on the face.
  const ConvexShape pillar = convex_box({0.3, 0.5, 0.3});
  const Manifold over = on_origin(capsule, turned({0, 0.69, 0}, {0, 0, 1}, pi / 2), pillar);
  ASSERT_EQ(over.count, 2);
  EXPECT_NEAR(std::abs(over.points[0].on_b.x), 0.3, 1e-3);
}

TEST(RoundManifold, ACapsuleOnTheEdgeOfABox) {
  const ConvexShape capsule = convex_capsule(0.2, 0.6), box = convex_box({0.5, 0.5, 0.5});
  const Vec3d n = normalized(Vec3d{1, 1, 0});
  // Perpendicular to n, at an angle to the edge.
  const BodyPose pose{Vec3d{0.5, 0.5, 0.1} + n * 0.17, Quatd::from_axis_angle({0, 0, 1}, pi / 4)};
  const Manifold m = on_origin(capsule, pose, box);
  ASSERT_EQ(m.count, 1);
  expect_vector(m.normal, n);
  EXPECT_NEAR(m.points[0].separation, -0.03, 1e-9);
  expect_vector(m.points[0].on_b, {0.5, 0.5, 0.1});
}

TEST(RoundManifold, ACapsuleAlongTheEdgeOfABoxHasTwoPoints) {
  const ConvexShape capsule = convex_capsule(0.2, 0.6), box = convex_box({0.5, 0.5, 0.5});
  const Vec3d n = normalized(Vec3d{1, 0, 1});
  for (const double tilt : {0.0, 1e-4}) {
    const BodyPose pose = turned(Vec3d{0.5, 0.3, 0.5} + n * 0.19, cross(Vec3d{0, 1, 0}, n), tilt);
    const Manifold m = on_origin(capsule, pose, box);
    ASSERT_EQ(m.count, 2);
    expect_vector(m.normal, n, 1e-3);
    EXPECT_NEAR(std::abs(m.points[0].on_b.y - m.points[1].on_b.y), 0.8, 1e-3);
    for (std::size_t k = 0; k < 2; ++k) EXPECT_NEAR(m.points[k].separation, -0.01, 1e-4);
  }
}

TEST(RoundManifold, CapsulesThatCrossTouchInOnePointAndParallelOnesInTwo) {
  const ConvexShape capsule = convex_capsule(0.2, 0.6);
  for (const double height : {0.39, 0.0}) {
    const Manifold crossed = test::find_fresh(capsule, turned({0, height, 0}, {0, 0, 1}, pi / 2), capsule,
                                              turned({0, 0, 0}, {1, 0, 0}, pi / 2), margin);
    ASSERT_EQ(crossed.count, 1);
    EXPECT_NEAR(std::abs(crossed.normal.y), 1, 1e-9);
    EXPECT_NEAR(crossed.points[0].separation, height - 0.4, 1e-9);
  }
  const Manifold parallel = on_origin(capsule, at(0.41, 0.3, 0), capsule);
  ASSERT_EQ(parallel.count, 2);
  expect_vector(parallel.normal, {1, 0, 0});
  EXPECT_NEAR(std::abs(parallel.points[0].on_b.y - parallel.points[1].on_b.y), 0.9, 1e-9);
  for (std::size_t k = 0; k < 2; ++k) EXPECT_NEAR(parallel.points[k].separation, 0.01, 1e-9);
  const Manifold in_line = on_origin(capsule, at(0, 1.58, 0), capsule);
  ASSERT_EQ(in_line.count, 1);
  expect_vector(in_line.normal, {0, 1, 0});
  EXPECT_NEAR(in_line.points[0].separation, -0.02, 1e-9);
}

TEST(RoundManifold, ACylinderStandsOnFourPoints) {
  const ConvexShape cylinder = convex_cylinder(0.5, 1, 32), box = convex_box({5, 0.5, 5});
  const Manifold standing = on_origin(cylinder, at(0, 1.49, 0), box);
  expect_vector(standing.normal, {0, 1, 0});
  expect_flat(standing, -0.01, 0.5);  // the square in a circle
}

TEST(RoundManifold, ACylinderOnItsSideIsRoundAtAnyAngle) {
  const ConvexShape cylinder = convex_cylinder(0.5, 1, 12), floor = convex_box({5, 0.5, 5});
  const ConvexShape across = convex_cylinder(0.25, 4, 12);
  const ContactTriangle triangle{{{{-5, 0.5, -5}, {0, 0.5, 5}, {5, 0.5, -5}}}};
  const Quatd lie = Quatd::from_axis_angle({0, 0, 1}, pi / 2);
  for (int i = 0; i < 40; ++i) {
    const BodyPose pose{{0, 0.99, 0}, lie * Quatd::from_axis_angle({0, 1, 0}, 0.05 * i)};
    AxisCache cache;
    // On a box, a triangle, a plane and a cylinder that lies in parallel.
    const std::array<Manifold, 4> all{
        on_origin(cylinder, pose, floor), find_manifold(cylinder, pose, triangle, {}, margin, cache),
        find_manifold(cylinder, pose, Plane{.offset = 0.5f}, {}, margin),
        test::find_fresh(cylinder, pose, across, {{0, 0.25, 0}, pose.rotation}, margin)};
    for (const Manifold& m : all) {
      ASSERT_EQ(m.count, 2);
      expect_vector(m.normal, {0, 1, 0});
      EXPECT_EQ(m.radius_a, 0.5);
      for (std::size_t k = 0; k < 2; ++k) {
        EXPECT_NEAR(m.points[k].separation, -0.01, 1e-9);
        // The centers are the ends of the axis: they stay when the cylinder rolls.
        const Vec3d center = m.points[k].on_a + pose.local_direction(m.normal) * m.radius_a;
        expect_vector({center.x, std::abs(center.y), center.z}, {0, 1, 0});
      }
    }
    EXPECT_EQ(all[3].radius_b, 0.25);
  }
}

TEST(RoundManifold, ACylinderLeansOnItsRim) {
  const ConvexShape cylinder = convex_cylinder(0.5, 1, 24);
  for (int i = 0; i < 200; ++i) {
    const double lean = i * 0.01;  // between its axis and the vertical
    const Quatd roll = Quatd::from_axis_angle({0, 1, 0}, 0.1 * i);
    const BodyPose pose{{0, 0, 0}, Quatd::from_axis_angle({1, 0, 0}, lean) * roll};
    const double lowest = -0.5 * std::abs(std::sin(lean)) - std::abs(std::cos(lean));
    const Manifold m = find_manifold(cylinder, pose, Plane{.offset = -1}, {}, 2);
    // Nearly upright, it stands on the vertices of the prism. Nearly on its side, it touches below its axis.
    const double tolerance = lean < 0.21 || std::abs(std::cos(lean)) < 0.02 ? 1e-3 : 1e-9;
    EXPECT_NEAR(test::least_separation(m), lowest + 1, tolerance) << lean;
  }
}

TEST(RoundManifold, ACylinderHasNoRoundEnds) {
  const ConvexShape cylinder = convex_cylinder(0.5, 1, 24), post = convex_box({0.1, 0.5, 0.1});
  const Quatd lie = Quatd::from_axis_angle({0, 0, 1}, pi / 2);
  // A post beside the end, below the axis, and one under the end.
  EXPECT_EQ(on_origin(cylinder, {{1.25, 0.9, 0}, lie}, post).count, 0);
  const Manifold m = on_origin(cylinder, {{1.05, 0.99, 0}, lie}, post);
  ASSERT_EQ(m.count, 2);
  expect_vector(m.normal, {0, 1, 0});
  EXPECT_NEAR(test::least_separation(m), -0.01, 1e-9);
}

TEST(RoundManifold, ARoundedBoxStandsOnFourPoints) {
  const ConvexShape core = convex_box({0.5, 0.5, 0.5});
  std::vector<FaceLoop> faces;
  for (const ConvexFace& f : core.faces) {
    faces.emplace_back();
    for (std::uint32_t c = f.begin; c < f.end; ++c) faces.back().push_back(core.corners[c].vertex);
  }
  const ConvexShape rounded = convex_polyhedron(core.vertices, faces, 0.1);
  for (const double gap : {-0.02, 0.02, -0.12}) {  // the last one: overlapping cores
    const Manifold m = on_origin(rounded, at(0.2, 1.1 + gap, 0.1), core);
    expect_vector(m.normal, {0, 1, 0});
    expect_flat(m, gap, 0.8 * 0.9);
  }
}

TEST(ConvexManifold, AFarPairIsRejectedByItsCachedAxisWithTheSameResult) {
  const ConvexShape box = convex_box({0.5, 0.5, 0.5});
  AxisCache cache;
  const BodyPose away = turned({1.5, 0.3, 0.2}, {1, 2, 3}, 0.7);
  EXPECT_EQ(find_manifold(box, away, box, at(0, 0, 0), 1e-3, cache).count, 0);
  EXPECT_NE(cache.kind, AxisCache::Kind::none);
  EXPECT_EQ(find_manifold(box, away, box, at(0, 0, 0), 1e-3, cache).count, 0);
  // A cache of another pair does no harm.
  cache = {AxisCache::Kind::face_of_b, 1000, 1000, {}, {}};
  const Manifold m = find_manifold(box, at(0, 0.99, 0), box, at(0, 0, 0), margin, cache);
  EXPECT_EQ(m.count, 4);
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

std::vector<ContactTriangle> triangles_of(const MeshShape& mesh) {
  std::vector<ContactTriangle> out;
  for (std::uint32_t t = 0; t < mesh.size(); ++t) out.push_back(mesh.triangle(t, false));
  return out;
}

/// A square of many triangles, columns x columns, at heights given by a function of x.
template <class Height>
MeshShape terrain(int columns, double size, const Height& height) {
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
  return {x, triangles};
}

TEST(TriangleManifold, ABoxSlidesOverInnerEdgesOfAFlatMeshWithoutAPushAside) {
  const std::vector<ContactTriangle> floor = triangles_of(terrain(10, 5, [](double) { return 0.0; }));
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
  const std::vector<ContactTriangle> ridge =
      triangles_of(terrain(4, 4, [&](double x) { return -slope * std::abs(x); }));
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

TEST(MeshManifold, ABoxOnManyTrianglesHasFourPointsThatPersistWhenItSlides) {
  const MeshShape floor = terrain(20, 5, [](double) { return 0.0; });
  const ConvexShape box = convex_box({0.3, 0.2, 0.4});
  std::set<std::uint32_t> first;
  for (int i = 0; i < 100; ++i) {
    std::array<Manifold, 8> found;
    const BodyPose pose{{-0.5 + 0.01 * i, 0.199 + 1e-6 * std::sin(i), 0.003 * i},
                        Quatd::from_axis_angle({0, 1, 0}, 0.3)};
    ASSERT_EQ(find_manifolds(box, pose, floor, {}, margin, found), 1) << i;
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
  const MeshShape bent = terrain(10, 5, [](double x) { return x > 0 ? 8 * x : 0.0; });
  const Vec3d wall = normalized(Vec3d{-8, 1, 0});
  const ConvexShape ball = convex_sphere(0.2);
  std::array<Manifold, 8> found;
  // At 0.19 from the floor and from the wall.
  const double x = -0.19 * (1 - wall.y) / -wall.x;
  ASSERT_EQ(find_manifolds(ball, at(x, 0.19, 0.1), bent, {}, margin, found), 2);
  for (int m = 0; m < 2; ++m) {
    ASSERT_EQ(found[static_cast<std::size_t>(m)].count, 1);
    EXPECT_NEAR(found[static_cast<std::size_t>(m)].points[0].separation, -0.01, 1e-9);
  }
  expect_vector(found[0].normal + found[1].normal, wall + Vec3d{0, 1, 0});
}

TEST(MeshManifold, PushesToTheSideOnWhichTheShapeLies) {
  const MeshShape floor = terrain(10, 5, [](double) { return 0.0; });
  const ConvexShape box = convex_box({0.3, 0.3, 0.3});
  std::array<Manifold, 8> found;
  for (const double side : {1.0, -1.0}) {
    ASSERT_EQ(find_manifolds(box, at(0.1, side * 0.25, 0.1), floor, {}, margin, found), 1);
    expect_vector(found[0].normal, {0, side, 0});
    EXPECT_NEAR(test::least_separation(found[0]), -0.05, 1e-9);
  }
}

TEST(MeshManifold, ABoxThatStandsOverTheRimOfASlabIsNotPushedAside) {
  const TriangleMesh slab = box({4, 0.4, 4});
  for (const bool inside_out : {false, true}) {
    std::vector<Triangle> triangles = slab.triangles;
    for (Triangle& t : triangles)
      if (inside_out) std::swap(t[1], t[2]);
    const MeshShape mesh(slab.positions, triangles);
    std::array<Manifold, 8> found;
    for (const double x : {1.7, 1.9, 1.99}) {
      ASSERT_EQ(find_manifolds(convex_box({0.3, 0.3, 0.3}), at(x, 0.4999, 0.1), mesh, {}, margin, found), 1);
      expect_vector(found[0].normal, {0, 1, 0});
      EXPECT_NEAR(test::least_separation(found[0]), -1e-4, 1e-6);
    }
  }
}

TEST(MeshShape, LeansOfABoxAreThoseOfRightAnglesAndOfAPitAreZero) {
  const std::vector<Vec3d> x{{0, 0, 0}, {0, 0, 1}, {1, 0, 0}, {0, -1, 0}, {0, 1, 0}};
  for (const std::uint32_t other : {3u, 4u})                                         // falls away, rises
    for (const Triangle& second : {Triangle{1, 0, other}, Triangle{0, 1, other}}) {  // wound alike or not
      const MeshShape mesh(x, std::vector<Triangle>{{0, 1, 2}, second});
      EXPECT_EQ(mesh.piece(0), mesh.piece(1));
      EXPECT_NEAR(mesh.triangle(0, false).lean[0], other == 3 ? 1 : 0, 1e-12);
      EXPECT_NEAR(mesh.triangle(0, false).lean[1], 1, 1e-12);
      EXPECT_NEAR(mesh.triangle(0, true).lean[2], other == 3 ? 0 : 1, 1e-12);
      EXPECT_NEAR(mesh.triangle(0, true).lean[1], 1, 1e-12);
    }
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

}  // namespace souple::test_rigid_manifold
