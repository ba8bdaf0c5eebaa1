#include "souple/contacts/collider_queries.h"
#include "tests/collision/random.h"

#include <gtest/gtest.h>

namespace souple::test_collision_queries {

using test::Random;

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
  const Shape shapes[] = {Plane{{1, 2, -2}, 0.6f}, Sphere{{0.1f, -0.2f, 0.3f}, 0.7f},
                          Box{{0.2f, 0.1f, 0}, {0.5f, 0.9f, 0.05f}}, Capsule{{-0.1f, 0, 0.2f}, 0.3f, 0.6f},
                          Cylinder{{0, 0.2f, 0.1f}, 0.6f, 0.3f}};
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

TEST(Queries, NearestColliderWhereItIsAtThatTime) {
  std::vector<Collider> colliders(3);
  colliders[0].shape = Box{};
  colliders[1].shape = Sphere{};
  colliders[1].motion = ColliderMotion::keyframes({{0, {0, 0, 0}, {}}, {1, {0, 2, 0}, {}}});
  colliders[2].shape = Sphere{{0, 4, 0}, 0.5f};
  colliders[2].enabled = false;
  const auto hit = ray_cast(colliders, 1.0, {0, 9, 0}, {0, -1, 0});
  ASSERT_TRUE(hit);
  EXPECT_EQ(hit->collider, 1u);
  EXPECT_NEAR(hit->hit.distance, 6.5, 1e-12);
  EXPECT_EQ(ray_cast(colliders, 0.0, {0.4, 9, 0.4}, {0, -1, 0})->collider, 0u);
}

TEST(Queries, ClosestPointOnATurnedBox) {
  Collider collider;
  collider.shape = Box{{}, {1, 0.5f, 0.5f}};
  collider.motion = ColliderMotion::fixed({{10, 0, 0}, Quatd::from_axis_angle({0, 0, 1}, pi / 2), 1});
  const SurfaceDistance s = surface_distance(collider, 0, {10, 3, 0});
  EXPECT_NEAR(s.distance, 2, 1e-12);
  EXPECT_NEAR(s.normal.y, 1, 1e-12);
  EXPECT_NEAR(length(closest_point(Box{}, {2, 0.25, 0}) - Vec3d{0.5, 0.25, 0}), 0, 1e-12);
}

}  // namespace souple::test_collision_queries
