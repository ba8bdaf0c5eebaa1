#include "souple/world/debug_draw.h"
#include "tests/world/rigid_bodies.h"

#include <cstddef>
#include <vector>

#include <gtest/gtest.h>

// Contacts of rigid bodies with each other and with colliders, as World::contacts and World::contact_pairs tell them.

namespace souple::test_world_rigid_body_contacts {

constexpr double g = 9.81;  // m/s^2

TEST(RigidBodyContacts, CarryTheWeightOfABox) {
  World world;
  const ColliderId floor = world.add_collider(Plane{}, {.name = "floor"});
  const ObjectId box = world.add_rigid_body(small_box, {.density = 700}, at(0.3, 0.1, 0));
  run(world, 1);
  const double h = 1.0 / 60 / world.settings().substeps;
  ASSERT_EQ(world.contacts().size(), 4u);
  EXPECT_EQ(world.report().contacts, 4u);
  double force = 0;
  Vec3d torque;
  for (const ContactEvent& event : world.contacts()) {
    EXPECT_EQ(event.object_id, box);
    EXPECT_TRUE(event.other_is_collider);
    EXPECT_EQ(event.collider_id, floor);
    EXPECT_EQ(event.other, "floor");
    EXPECT_NEAR(event.normal.y, 1, 1e-6);
    EXPECT_NEAR(event.point.y, 0, 1e-3);
    EXPECT_LT(length(world.positions(box)[event.vertex] - event.point), 1e-3);
    force += static_cast<double>(event.impulse) / h;
    torque += cross(Vec3d(event.point) - Vec3d{0.3, 0, 0}, Vec3d(event.normal * event.impulse)) / h;
  }
  const double weight = world.rigid_body(box).mass * g;
  EXPECT_NEAR(force, weight, 0.01 * weight);
  EXPECT_LT(length(torque), 0.01 * weight * 0.1);
}

TEST(RigidBodyContacts, ABodyCarriesTheNext) {
  World world;
  world.add_collider(Plane{});
  const ObjectId below = world.add_rigid_body(small_box, {}, at(0, 0.1, 0));
  const ObjectId above = world.add_rigid_body(Sphere{{}, 0.1f}, {}, at(0, 0.3, 0));
  run(world, 1);
  const double h = 1.0 / 60 / world.settings().substeps;
  double between = 0, floor = 0;
  for (const ContactEvent& event : world.contacts()) {
    if (event.other_is_collider) {
      floor += static_cast<double>(event.impulse) / h;
      continue;
    }
    EXPECT_EQ(event.object_id, below);
    EXPECT_EQ(event.other_id, above);
    EXPECT_NEAR(event.normal.y, -1, 1e-3);
    EXPECT_NEAR(event.point.y, 0.2, 1e-3);
    between += static_cast<double>(event.impulse) / h;
  }
  const double weight = world.rigid_body(above).mass * g;
  EXPECT_NEAR(between, weight, 0.01 * weight);
  const double both = weight + world.rigid_body(below).mass * g;
  EXPECT_NEAR(floor, both, 0.01 * both);
}

TEST(RigidBodyContacts, PairsBeginAndEnd) {
  World world;
  const ColliderId floor = world.add_collider(Plane{});
  const ObjectId box = world.add_rigid_body(small_box, {}, at(0, 0.12, 0));
  world.track_contacts(true);
  std::vector<ContactPhase> phases;
  double impulse = 0;
  for (int frame = 0; frame < 60; ++frame) {
    if (frame == 30) world.set_body_velocity(box, {0, 3, 0}, {});
    world.step(1.0 / 60);
    for (const ContactPair& pair : world.contact_pairs()) {
      EXPECT_EQ(pair.object, box);
      EXPECT_TRUE(pair.is_collider);
      EXPECT_EQ(pair.collider, floor);
      phases.push_back(pair.phase);
      if (frame == 29) impulse = static_cast<double>(pair.impulse);
    }
  }
  ASSERT_GE(phases.size(), 3u);
  EXPECT_EQ(phases.front(), ContactPhase::begin);
  EXPECT_EQ(phases.back(), ContactPhase::end);
  for (std::size_t k = 1; k + 1 < phases.size(); ++k) EXPECT_EQ(phases[k], ContactPhase::persist) << k;
  const double weight = world.rigid_body(box).mass * g;
  EXPECT_NEAR(impulse, weight / 60, 0.01 * weight / 60);
}

TEST(RigidBodyContacts, AreDrawn) {
  World world;
  world.add_collider(Plane{});
  world.add_rigid_body(small_box, {}, at(0, 0.1, 0));
  run(world, 0.2);
  std::size_t drawn = 0;
  DebugDraw draw;
  draw.contact = [&](const DebugContact& contact) { drawn += contact.impulse > 0 ? 1 : 0; };
  world.debug_draw(draw);
  EXPECT_EQ(drawn, 4u);
}

}  // namespace souple::test_world_rigid_body_contacts
