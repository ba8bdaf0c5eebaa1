#include "souple/contacts/collider_queries.h"
#include "souple/error.h"
#include "tests/collision/random.h"

#include <limits>

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
  try {
    validate(Sphere{{}, -2}, "collider 'ball'");
  } catch (const Error& error) {
    EXPECT_STREQ(error.what(),
                 "collider 'ball': sphere radius is -2; expected a finite length above 0, in meters");
  }
}

}  // namespace souple::test_collision_shapes
