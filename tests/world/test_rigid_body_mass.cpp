#include "tests/expect_error.h"
#include "tests/world/rigid_bodies.h"

#include <vector>

#include <gtest/gtest.h>

// Mass, center and inertia that are given, and bodies of several shapes.

namespace souple::test_world_rigid_body_mass {

TEST(RigidBodyMass, MayBeGiven) {
  World world;
  ObjectOptions options = at(1, 2, 3);
  options.given_mass.mass = 12;
  const RigidBodyState state = world.rigid_body(world.add_rigid_body(small_box, {}, options));
  EXPECT_NEAR(state.mass, 12, 1e-9);
  EXPECT_NEAR(state.inertia.y, 12 * 0.08 / 12, 1e-7);
  options.given_mass.center = Vec3d{0, -0.05, 0};
  options.given_mass.inertia = Mat3d::diagonal({0.1, 0.2, 0.15});
  options.transform.rotation = Quatd::from_axis_angle({1, 0, 0}, 3.14159265358979 / 2);
  const RigidBodyState low = world.rigid_body(world.add_rigid_body(box({0.2, 0.2, 0.2}, 2), {}, options));
  EXPECT_NEAR(low.mass, 12, 1e-9);
  EXPECT_LT(length(low.pose.translation - Vec3d{1, 2, 2.95}), 1e-9);
  const Mat3d R = rotation_matrix(low.pose.rotation);
  const Mat3d I = R * Mat3d::diagonal(low.inertia) * transpose(R);
  EXPECT_NEAR(I.column[0].x, 0.1, 1e-9);
  EXPECT_NEAR(I.column[1].y, 0.15, 1e-9);
  EXPECT_NEAR(I.column[2].z, 0.2, 1e-9);
}

// A box whose center of mass is low rights itself as a tumbler does not: it stays upright further.
TEST(RigidBodyMass, ALowCenterKeepsABoxUpright) {
  World world;
  world.add_collider(Plane{});
  const auto tilted = [&](double z, double center) {
    ObjectOptions options = at(0, 0.55, z);
    options.transform.rotation = Quatd::from_axis_angle({0, 0, 1}, 0.5);
    options.given_mass.center = Vec3d{0, center, 0};
    return world.add_rigid_body(Box{{}, {0.2f, 0.5f, 0.2f}}, {}, options);
  };
  const ObjectId low = tilted(0, -0.4), middle = tilted(2, 0);
  run(world, 3);
  EXPECT_GT(world.rigid_body(low).pose.direction({0, 1, 0}).y, 0.99);
  EXPECT_LT(std::abs(world.rigid_body(middle).pose.direction({0, 1, 0}).y), 0.1);
}

TEST(RigidBodyMass, ThatCannotBeIsRefusedInWords) {
  World world;
  ObjectOptions options = at(0, 0, 0);
  options.given_mass.mass = -1;
  expect_error([&] { world.add_rigid_body(small_box, {}, options); }, {"rigid_body", "mass", "-1"});
  options.given_mass = {.inertia = Mat3d::diagonal({1, 1, 5})};
  expect_error([&] { world.add_rigid_body(small_box, {}, options); }, {"rigid_body", "inertia"});
  expect_error([&] { world.add_cloth(grid(3, 3, 1), material::cotton, options); }, {"given_mass", "cloth"});
}

std::vector<RigidPart> dumbbell() {
  return {{Box{{}, {0.3f, 0.02f, 0.02f}}, {}, {}},
          {Sphere{{}, 0.1f}, {{-0.3, 0, 0}, {}, 1}, 2000},
          {Sphere{{}, 0.1f}, {{0.3, 0, 0}, {}, 1}, 2000}};
}

TEST(RigidBodyParts, AddUpTheirMassAndInertia) {
  World world;
  const ObjectId body = world.add_rigid_body(dumbbell(), {.density = 1000}, at(0, 1, 0));
  const RigidBodyState state = world.rigid_body(body);
  const double rod = 1000 * 0.6 * 0.04 * 0.04, ball = 2000 * 4.0 / 3 * 3.14159265358979 * 1e-3;
  const double along = rod * (0.0032) / 12 + 2 * 0.4 * ball * 0.01;
  const double across = rod * (0.36 + 0.0016) / 12 + 2 * ball * (0.4 * 0.01 + 0.09);
  EXPECT_NEAR(state.mass, rod + 2 * ball, 1e-4);
  EXPECT_LT(length(state.pose.translation - Vec3d{0, 1, 0}), 1e-7);
  EXPECT_NEAR(state.inertia.x, along, 1e-4 * along);
  EXPECT_NEAR(state.inertia.y, across, 1e-4 * across);
  EXPECT_NEAR(state.inertia.z, across, 1e-4 * across);
}

TEST(RigidBodyParts, CollideEach) {
  World world;
  world.add_collider(Plane{});
  ObjectOptions options = at(0, 0.3, 0);
  options.transform.rotation = Quatd::from_axis_angle({0, 1, 0}, 0.3);
  const ObjectId body = world.add_rigid_body(dumbbell(), {.density = 1000}, options);
  const ObjectId between = world.add_rigid_body(Sphere{{}, 0.05f}, {}, at(0, 0.6, 0));
  run(world, 2);
  // It lies on its two balls, and what falls onto the rod rolls off or lies on it.
  EXPECT_NEAR(world.rigid_body(body).pose.translation.y, 0.1, 2e-3);
  EXPECT_GT(world.rigid_body(between).pose.translation.y, 0.049);
  EXPECT_EQ(world.report().intersections, 0u);
}

TEST(RigidBodyParts, ScaleWithTheBody) {
  World world;
  ObjectOptions options = at(0, 1, 0);
  options.transform.scale = 2;
  const ObjectId large = world.add_rigid_body(dumbbell(), {}, options);
  const ObjectId small = world.add_rigid_body(dumbbell(), {}, at(0, 5, 0));
  EXPECT_NEAR(world.rigid_body(large).mass / world.rigid_body(small).mass, 8, 1e-5);
  EXPECT_NEAR(world.rigid_body(large).inertia.y / world.rigid_body(small).inertia.y, 32, 1e-4);
}

TEST(RigidBodyParts, ThatCannotBeAreRefusedInWords) {
  World world;
  expect_error([&] { world.add_rigid_body(std::vector<RigidPart>{}); }, {"no shapes"});
  expect_error(
      [&] {
        world.add_rigid_body(std::vector<RigidPart>{{Plane{}, {}, {}}});
      },
      {"shape 0", "plane"});
  expect_error(
      [&] {
        world.add_rigid_body(std::vector<RigidPart>{{Sphere{}, {{}, {}, 2}, {}}});
      },
      {"shape 0", "scale"});
}

}  // namespace souple::test_world_rigid_body_mass
