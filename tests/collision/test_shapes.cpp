#include "souple/collision/collider_mesh.h"
#include "souple/collision/collider_motion.h"
#include "souple/contacts/collider_queries.h"
#include "souple/error.h"
#include "tests/collision/random.h"
#include "tests/expect_error.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <vector>

#include <gtest/gtest.h>

namespace souple::test_collision_shapes {

using test::Random;

const Shape shapes[] = {Plane{{1, 2, -2}, 0.6f}, Sphere{{0.1f, -0.2f, 0.3f}, 0.7f},
                        Box{{0.2f, 0.1f, 0}, {0.5f, 0.9f, 0.05f}}, Capsule{{-0.1f, 0, 0.2f}, 0.3f, 0.6f},
                        Cylinder{{0, 0.2f, 0.1f}, 0.6f, 0.3f}};

// Whether a point is inside a shape, independently of distances.
bool contains(const Plane& s, const Vec3d& p) {
  return dot(Vec3d(s.normal), p) < double(s.offset);
}
bool contains(const Sphere& s, const Vec3d& p) {
  return length(p - Vec3d(s.center)) < double(s.radius);
}
bool contains(const Box& s, const Vec3d& p) {
  const Vec3d d = p - Vec3d(s.center), h(s.half_extents);
  return abs(d.x) < h.x && abs(d.y) < h.y && abs(d.z) < h.z;
}
bool contains(const Capsule& s, const Vec3d& p) {
  const Vec3d d = p - Vec3d(s.center), half{0, double(s.half_height), 0};
  const bool tube = abs(d.y) < half.y && d.x * d.x + d.z * d.z < double(s.radius) * double(s.radius);
  return tube || length(d - half) < double(s.radius) || length(d + half) < double(s.radius);
}
bool contains(const Cylinder& s, const Vec3d& p) {
  const Vec3d d = p - Vec3d(s.center);
  return abs(d.y) < double(s.half_height) && d.x * d.x + d.z * d.z < double(s.radius) * double(s.radius);
}
bool contains(const Shape& shape, const Vec3d& p) {
  return std::visit([&](const auto& s) { return contains(s, p); }, shape);
}

// The distance to the surface by bisection along many rays. No ray hits the surface nearer than the distance, and the
// ray along the normal hits it at the distance.
TEST(Shapes, DistanceIsThatOfTheNearestSurfacePoint) {
  for (const Shape& shape : shapes) {
    Random random(7);
    for (int k = 0; k < 200; ++k) {
      const Vec3d p = random.point(-1.5, 1.5);
      const SurfaceDistance s = surface_distance(shape, p);
      const bool inside = contains(shape, p);
      ASSERT_EQ(inside, s.distance < 0) << shape_name(shape);
      ASSERT_NEAR(length(s.normal), 1, 1e-12);
      const double distance = abs(s.distance);
      for (int ray = 0; ray < 200; ++ray) {
        const Vec3d d = normalized(random.point(-1, 1));
        ASSERT_EQ(contains(shape, p + d * (distance * (1 - 1e-9))), inside) << shape_name(shape);
      }
      ASSERT_EQ(contains(shape, p - s.normal * (s.distance + 1e-9)), true) << shape_name(shape);
      ASSERT_EQ(contains(shape, p - s.normal * (s.distance - 1e-9)), false) << shape_name(shape);
    }
  }
}

TEST(Shapes, NormalIsTheGradientOfTheDistance) {
  for (const Shape& shape : shapes) {
    Random random(11);
    int smooth = 0;
    for (int k = 0; k < 500; ++k) {
      const Vec3d p = random.point(-1.5, 1.5);
      const SurfaceDistance s = surface_distance(shape, p);
      constexpr double e = 1e-5;
      Vec3d forward, backward;
      for (int axis = 0; axis < 3; ++axis) {
        Vec3d step;
        step[axis] = e;
        forward[axis] = (surface_distance(shape, p + step).distance - s.distance) / e;
        backward[axis] = (s.distance - surface_distance(shape, p - step).distance) / e;
      }
      if (length(forward - backward) > 1e-2) continue;  // a ridge, for example inside a box
      ++smooth;
      ASSERT_LT(length((forward + backward) * 0.5 - s.normal), 1e-6) << shape_name(shape);
    }
    EXPECT_GT(smooth, 450) << shape_name(shape);
  }
}

// At centers, axes, edges, corners and distant points: a unit normal that leads to the surface.
TEST(Shapes, SpecialPointsHaveAUnitNormal) {
  for (const Shape& shape : shapes) {
    const Vec3d c = std::holds_alternative<Plane>(shape) ? Vec3d{} : bounding_ball(shape).center;
    for (const double x : {0.0, -0.5, 0.5, 0.6, 1e-200, 1e9}) {
      for (const double y : {0.0, 0.3, -0.9, 0.6, 1e-200, -1e9}) {
        for (const double z : {0.0, 0.05, -0.6, 1e-200}) {
          const Vec3d p = c + Vec3d{x, y, z};
          const SurfaceDistance s = surface_distance(shape, p);
          ASSERT_TRUE(std::isfinite(s.distance));
          ASSERT_NEAR(length(s.normal), 1, 1e-12) << shape_name(shape);
          ASSERT_NEAR(surface_distance(shape, p - s.normal * s.distance).distance, 0,
                      1e-15 * (1e3 + length(p)));
        }
      }
    }
  }
}

TEST(Shapes, BoundsHoldTheShapeAndAreTight) {
  for (const Shape& shape : shapes) {
    if (std::holds_alternative<Plane>(shape)) continue;
    const BoundingBall ball = bounding_ball(shape);
    const ShapeBounds box = shape_bounds(shape);
    Random random(3);
    for (int k = 0; k < 20000; ++k) {
      const Vec3d p = random.point(-2, 2);
      if (!contains(shape, p)) continue;
      ASSERT_LE(length(p - ball.center), ball.radius);
      for (int a = 0; a < 3; ++a) ASSERT_TRUE(p[a] >= box.lo[a] && p[a] <= box.hi[a]) << shape_name(shape);
    }
    for (int a = 0; a < 3; ++a) {
      Vec3d end = (box.lo + box.hi) * 0.5;
      end[a] = box.hi[a];
      EXPECT_NEAR(surface_distance(shape, end).distance, 0, 1e-7) << shape_name(shape);
    }
  }
  const ShapeBounds half_space = shape_bounds(Plane{{0, 2, 0}, 1});
  EXPECT_EQ(half_space.hi.y, 0.5);
  EXPECT_TRUE(std::isinf(half_space.lo.y) && std::isinf(half_space.hi.x));
}

TEST(Shapes, BadSizesAreRefusedByName) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const Shape bad[] = {Plane{{0, 0, 0}, 0},
                       Plane{{0, 1, 0}, nan},
                       Sphere{{}, 0},
                       Sphere{{nan, 0, 0}, 1},
                       Box{{}, {1, -1, 1}},
                       Capsule{{}, -1, 1},
                       Capsule{{}, 1, -1},
                       Cylinder{{}, 1, 0},
                       Cylinder{{}, nan, 1},
                       Box{{}, {1, 1, nan}},
                       Sphere{{}, std::numeric_limits<float>::infinity()}};
  for (const Shape& shape : bad) EXPECT_THROW(validate(shape, "collider 'ball'"), Error);
  for (const Shape& shape : shapes) EXPECT_NO_THROW(validate(shape, "collider"));
  EXPECT_EQ(error_of([] {
              validate(Sphere{{}, -2}, "collider 'ball'");
            }),
            "collider 'ball': sphere radius is -2; expected a finite length above 0, in meters");
}

const Quatd quarter = Quatd::from_axis_angle({0, 1, 0}, pi / 2);

TEST(ColliderMotion, KeyframesMoveLinearlyTurnEvenlyAndStayAtTheEnds) {
  const ColliderMotion motion = ColliderMotion::keyframes({{1, {0, 0, 0}, {}}, {3, {4, 0, 2}, quarter}});
  EXPECT_FALSE(motion.is_static());
  EXPECT_EQ(motion.at(-5).translation, (Vec3d{0, 0, 0}));
  EXPECT_EQ(motion.at(9).translation, (Vec3d{4, 0, 2}));
  EXPECT_EQ(motion.at(2).translation, (Vec3d{2, 0, 1}));
  for (const double s : {0.0, 0.1, 0.5, 0.75, 1.0}) {
    const Vec3d turned = motion.at(1 + 2 * s).direction({1, 0, 0});
    EXPECT_NEAR(atan2(-turned.z, turned.x), s * pi / 2, 1e-12);
  }
}

TEST(ColliderMotion, RotationTakesTheShorterArc) {
  const Quatd same_turn{-quarter.x, -quarter.y, -quarter.z, -quarter.w};
  const ColliderMotion motion = ColliderMotion::keyframes({{0, {}, {}}, {1, {}, same_turn}});
  const Vec3d turned = motion.at(0.5).direction({1, 0, 0});
  EXPECT_NEAR(atan2(-turned.z, turned.x), pi / 4, 1e-12);
}

TEST(ColliderMotion, ALoopRepeats) {
  const ColliderMotion motion =
      ColliderMotion::keyframes({{1, {0, 0, 0}, {}}, {2, {1, 0, 0}, {}}, {3, {0, 0, 0}, {}}}, true);
  for (const double t : {-0.75, 1.25, 3.25, 201.25}) EXPECT_NEAR(motion.at(t).translation.x, 0.25, 1e-9) << t;
}

TEST(ColliderMotion, OnlyALoopWhoseEndsDifferJumps) {
  const std::vector<PoseKey> there{{0, {0, 0, 0}, {}}, {1, {1, 0, 0}, {}}};
  std::vector<PoseKey> and_back = there;
  and_back.push_back({2, {0, 0, 0}, {}});
  EXPECT_TRUE(ColliderMotion::keyframes(there, true).jumps(2.99, 3.01));
  EXPECT_FALSE(ColliderMotion::keyframes(there, true).jumps(2.5, 2.6));
  EXPECT_FALSE(ColliderMotion::keyframes(there).jumps(0.99, 1.01));
  EXPECT_FALSE(ColliderMotion::keyframes(and_back, true).jumps(1.99, 2.01));
  const Quatd turned = Quatd::from_axis_angle({0, 1, 0}, 2 * pi);  // -q of the first, but for rounding
  and_back.back() = {2, {1e-17, 2e-7, 0}, turned};
  EXPECT_FALSE(ColliderMotion::keyframes(and_back, true).jumps(1.99, 2.01));
  and_back.back() = {2, {}, Quatd::from_axis_angle({0, 1, 0}, 1e-5)};
  EXPECT_TRUE(ColliderMotion::keyframes(and_back, true).jumps(1.99, 2.01));
}

TEST(ColliderMotion, BadKeysAreRefused) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(ColliderMotion::keyframes({}), Error);
  EXPECT_THROW(ColliderMotion::keyframes({{1, {}, {}}, {1, {}, {}}}), Error);
  EXPECT_THROW(ColliderMotion::keyframes({{nan, {}, {}}}), Error);
  EXPECT_THROW(ColliderMotion::keyframes({{0, {nan, 0, 0}, {}}}), Error);
  EXPECT_THROW(ColliderMotion::callback(nullptr), Error);
  EXPECT_THROW(ColliderMotion::callback([=](double) { return Transform{{nan, 0, 0}, {}, 1}; }).at(0), Error);
}

TEST(ColliderMotion, ACallbackIsAskedAndMayThrow) {
  const auto rise = ColliderMotion::callback([](double t) {
    if (t > 5) throw std::runtime_error("too late");
    return Transform{{0, t, 0}, {0, 0, 0, 2}, 3};
  });
  EXPECT_EQ(rise.at(2).point({1, 0, 0}), (Vec3d{1, 2, 0}));  // rigid: the callback's scale is ignored
  EXPECT_THROW(rise.at(6), std::runtime_error);
}

// A reference ray takes steps that cannot pass the surface. The ray cast must hit at its end.
double walk(const Shape& shape, const Vec3d& o, const Vec3d& d, double far) {
  double s = 0;
  while (s < far) {
    const double free = surface_distance(shape, o + d * s).distance;
    if (free < 1e-10) return s;
    s += free;
  }
  return far;
}

TEST(Queries, RayCastAgreesWithWalkingTheDistance) {
  for (const Shape& shape : shapes) {
    Random random(5);
    int hits = 0, misses = 0;
    for (int k = 0; k < 2000; ++k) {
      const Vec3d o = random.point(-2, 2), d = normalized(random.point(-1, 1));
      const double walked = walk(shape, o, d, 20);
      const auto hit = ray_cast(shape, o, d * 3.0, 20);
      ASSERT_EQ(hit.has_value(), walked < 20) << shape_name(shape);
      if (!hit) {
        ++misses;
        continue;
      }
      ++hits;
      ASSERT_NEAR(surface_distance(shape, hit->point).distance, min(0.0, surface_distance(shape, o).distance),
                  1e-9);
      ASSERT_NEAR(hit->distance, walked, 1e-4) << shape_name(shape);
    }
    EXPECT_GT(hits, 50) << shape_name(shape);
    EXPECT_GT(misses, 50) << shape_name(shape);
  }
}

TEST(Queries, RayAlongAnAxisMeetsTheFlatEnd) {
  const auto hit = ray_cast(Cylinder{{}, 0.5f, 1}, {0, 5, 0}, {0, -1, 0});
  ASSERT_TRUE(hit);
  EXPECT_NEAR(hit->distance, 4, 1e-12);
  EXPECT_EQ(hit->normal, (Vec3d{0, 1, 0}));
  EXPECT_FALSE(ray_cast(Cylinder{{}, 0.5f, 1}, {0, 5, 0}, {0, 1, 0}));
  EXPECT_FALSE(ray_cast(Sphere{}, {0, 5, 0}, {0, 0, 0}));
  EXPECT_FALSE(ray_cast(Sphere{}, {0, 5, 0}, {0, -1, 0}, 4.4));
}

TEST(Queries, DistanceFromATurnedBox) {
  Collider collider;
  collider.shape = Box{{}, {1, 0.5f, 0.5f}};
  collider.motion = ColliderMotion::fixed({{10, 0, 0}, Quatd::from_axis_angle({0, 0, 1}, pi / 2), 1});
  const SurfaceDistance s = surface_distance(collider, 0, {10, 3, 0});
  EXPECT_NEAR(s.distance, 2, 1e-12);
  EXPECT_NEAR(s.normal.y, 1, 1e-12);
}

const std::vector<Shape> drawn_shapes{
    Plane{{0.3f, 2, -0.5f}, 0.7f},  Sphere{{0.1f, 0.2f, 0.3f}, 0.8f}, Box{{1, -2, 0.5f}, {0.5f, 0.2f, 1.5f}},
    Capsule{{0, 1, 0}, 0.3f, 0.6f}, Capsule{{0, 1, 0}, 0.3f, 0},      Cylinder{{0.4f, 0, 0}, 0.25f, 0.9f}};

TEST(ColliderMesh, VerticesLieOnTheShape) {
  for (const Shape& shape : drawn_shapes) {
    const ColliderMesh mesh = collider_mesh(shape, {0.5, 0.5, 0.5}, 3);
    ASSERT_FALSE(mesh.triangles.empty());
    for (const Vec3f& x : mesh.positions)
      ASSERT_NEAR(surface_distance(shape, Vec3d(x)).distance, 0, 2e-6) << shape_name(shape);
  }
}

TEST(ColliderMesh, FacesAndNormalsPointOut) {
  for (const Shape& shape : drawn_shapes) {
    const ColliderMesh mesh = collider_mesh(shape, {0.5, 0.5, 0.5}, 3);
    ASSERT_EQ(mesh.normals.size(), mesh.positions.size());
    for (const Triangle& t : mesh.triangles) {
      const Vec3d a(mesh.positions[t[0]]), b(mesh.positions[t[1]]), c(mesh.positions[t[2]]);
      const Vec3d face = normalized(cross(b - a, c - a)), middle = (a + b + c) / 3.0;
      // A step along the face's normal leaves the solid.
      EXPECT_GT(surface_distance(shape, middle + face * 0.02).distance,
                surface_distance(shape, middle).distance + 0.015)
          << shape_name(shape);
      for (const std::uint32_t v : t) {
        ASSERT_NEAR(length(mesh.normals[v]), 1, 1e-5);
        EXPECT_GT(dot(Vec3d(mesh.normals[v]), face), 0.9) << shape_name(shape);
      }
    }
  }
}

TEST(ColliderMesh, EdgesOfBoxesAreSharpAndBallsAreSmooth) {
  const ColliderMesh solid = collider_mesh(Box{}, {}, 1);
  for (const Vec3f& n : solid.normals) {
    const float largest = std::max({std::abs(n.x), std::abs(n.y), std::abs(n.z)});
    EXPECT_NEAR(largest, 1, 1e-6);  // along an axis: no rounding of edges by averaged normals
  }
  const ColliderMesh ball = collider_mesh(Sphere{}, {}, 1);
  EXPECT_GE(ball.triangles.size(), 2000u);
  for (std::size_t v = 0; v < ball.positions.size(); ++v)
    EXPECT_GT(dot(normalized(ball.positions[v]), ball.normals[v]), 0.99999f);
  // A cylinder has both: normals along its axis on the caps, across it on the side, none between.
  for (const Vec3f& n : collider_mesh(Cylinder{}, {}, 1).normals)
    EXPECT_TRUE(std::abs(n.y) < 1e-5f || std::abs(n.y) > 0.99999f);
}

TEST(ColliderMesh, APlaneIsASquareAroundWhatIsThere) {
  const Plane plane{{0, 0, 2}, -3};  // z = -1.5
  const ColliderMesh mesh = collider_mesh(plane, {4, 5, 6}, 2);
  ASSERT_EQ(mesh.positions.size(), 4u);
  Vec3f middle{};
  for (const Vec3f& x : mesh.positions) middle += x / 4.0f;
  EXPECT_NEAR(length(middle - Vec3f{4, 5, -1.5f}), 0, 1e-5);
  for (const Vec3f& x : mesh.positions) EXPECT_NEAR(length(x - middle), 2 * std::sqrt(2.0f), 1e-5);
}

}  // namespace souple::test_collision_shapes
