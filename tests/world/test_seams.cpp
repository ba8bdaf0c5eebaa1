#include "tests/world/scene.h"

#include <cmath>
#include <string>

#include <gtest/gtest.h>

// Bodies that slide from one body to the next: flush faces do not push them aside.

namespace souple::test_world_seams {

constexpr RigidBodyMaterial smooth{.friction = 0};

/// A row of flush boxes of 0.5 m along x, from x = -3, with its top at y = 0.
void add_row(World& world, const std::string& kind) {
  for (int k = 0; k < 12; ++k) {
    const Vec3d center{-2.75 + 0.5 * k, -0.25, 0};
    const Box tile{{}, {0.25f, 0.25f, 0.5f}};
    if (kind == "colliders")
      world.add_collider(tile, {.friction = 0, .motion = ColliderMotion::fixed({center, {}, 1})});
    if (kind == "kinematic bodies") world.set_kinematic(world.add_rigid_body(tile, smooth, at(center)), true);
    if (kind == "loose bricks") world.add_rigid_body(tile, smooth, at(center));
    if (kind == "meshes") world.add_obstacle(box({0.5, 0.5, 1}), {.friction = 0}, {}, at(center));
  }
  if (kind == "loose bricks")
    world.add_collider(Plane{}, {.friction = 0, .motion = ColliderMotion::fixed({{0, -0.5, 0}, {}, 1})});
}

TEST(Seams, ACrateSlidesOverThemAtItsSpeed) {
  for (const std::string kind : {"colliders", "kinematic bodies", "loose bricks", "meshes"})
    for (const bool hull : {false, true}) {
      World world({.threads = 1});
      add_row(world, kind);
      ObjectOptions options = at(-2.75, 0.1, 0);
      options.transform.rotation = Quatd::from_axis_angle({0, 1, 0}, hull ? 0.17 : 0);
      options.velocity = {3, 0, 0};
      const ObjectId crate = hull ? world.add_rigid_body(box({0.2, 0.2, 0.2}), smooth, options)
                                  : world.add_rigid_body(small_box, smooth, options);
      run(world, 1.7);
      const RigidBodyState state = world.rigid_body(crate);
      EXPECT_GT(state.velocity.x, 2.97) << kind << hull;
      EXPECT_LT(length(state.angular_velocity), 0.05) << kind << hull;
      EXPECT_NEAR(state.pose.translation.z, 0, 0.01) << kind << hull;
    }
}

TEST(Seams, OfAWallDoNotThrowACrateOff) {
  World world({.threads = 1});
  for (int k = 0; k < 8; ++k)
    world.add_collider(Box{{-0.25f, 0.25f + 0.5f * static_cast<float>(k), 0}, {0.25f, 0.25f, 0.5f}},
                       {.friction = 0});
  const ObjectId crate = world.add_rigid_body(small_box, smooth, at(0.1, 3.7, 0));
  run(world, 0.7);
  EXPECT_LT(length(world.rigid_body(crate).velocity - Vec3d{0, -0.7 * 9.81, 0}), 0.05);
  EXPECT_LT(std::abs(world.rigid_body(crate).velocity.x), 0.01);
}

TEST(Seams, AStepOfFiveMillimetersStopsACrate) {
  World world({.threads = 1});
  world.add_collider(Plane{}, {.friction = 0});
  world.add_collider(Box{{1, 0.0025f, 0}, {0.5f, 0.0025f, 0.5f}}, {.friction = 0});
  const ObjectId crate = world.add_rigid_body(
      small_box, smooth, {.transform = {.translation = {0, 0.1, 0}}, .velocity = {0.5f, 0, 0}});
  run(world, 2);
  EXPECT_LT(world.rigid_body(crate).pose.translation.x, 0.401);
  EXPECT_LT(world.rigid_body(crate).velocity.x, 0.05);
}

}  // namespace souple::test_world_seams
