#include "souple/souple.h"
#include "tests/expect_error.h"

#include <gtest/gtest.h>

namespace souple::test_world_contact_pairs {

constexpr double frame = 1.0 / 60;

TEST(ContactPairs, BeginPersistAndEnd) {
  World world;
  const Vec3d grain[] = {{0, 0.3, 0}};
  const ObjectId ball = world.add_grains(grain, {.radius = 0.1f, .density = 1000});
  const ColliderId floor = world.add_collider(Plane{});
  world.track_contacts(true);
  int begins = 0, persists = 0;
  double impulse = 0;
  for (int i = 0; i < 60; ++i) {
    world.step(frame);
    for (const ContactPair& pair : world.contact_pairs()) {
      EXPECT_EQ(pair.object, ball);
      EXPECT_TRUE(pair.is_collider);
      EXPECT_EQ(pair.collider, floor);
      EXPECT_FALSE(pair.is_sensor);
      EXPECT_LT(length(pair.normal - Vec3f{0, 1, 0}), 1e-5f);
      EXPECT_NEAR(pair.point.y, 0, 1e-4);
      begins += pair.phase == ContactPhase::begin ? 1 : 0;
      persists += pair.phase == ContactPhase::persist ? 1 : 0;
      EXPECT_NE(pair.phase, ContactPhase::end);
      impulse += static_cast<double>(pair.impulse);
    }
  }
  // It falls 0.2 m in 0.2 s, then lies.
  EXPECT_EQ(begins, 1);
  EXPECT_GE(persists, 45);
  // The floor took all its weight: m g t.
  EXPECT_NEAR(impulse, world.total_mass(ball) * 9.81, 0.05 * world.total_mass(ball) * 9.81);
  world.teleport(ball, {.translation = {0, 1, 0}});
  world.step(frame);
  ASSERT_EQ(world.contact_pairs().size(), 1u);
  EXPECT_EQ(world.contact_pairs()[0].phase, ContactPhase::end);
  EXPECT_EQ(world.contact_pairs()[0].impulse, 0);
  world.step(frame);
  EXPECT_TRUE(world.contact_pairs().empty());
}

// A ball that bounces within a step touches in that step.
TEST(ContactPairs, ABounceWithinAStepIsSeen) {
  World world({.substeps = 10});
  const Vec3d grain[] = {{0, 0.3, 0}};
  const ObjectId ball = world.add_grains(grain, {.radius = 0.1f, .friction = 0, .restitution = 1});
  world.add_collider(Plane{}, {.friction = 0, .restitution = 1});
  const Vec3f fast[] = {{0, -20, 0}};
  world.set_velocities(ball, fast);
  world.track_contacts(true);
  world.step(frame);
  EXPECT_GT(world.velocities(ball)[0].y, 10);
  EXPECT_TRUE(world.contacts().empty());
  ASSERT_EQ(world.contact_pairs().size(), 1u);
  EXPECT_EQ(world.contact_pairs()[0].phase, ContactPhase::begin);
  world.step(frame);
  ASSERT_EQ(world.contact_pairs().size(), 1u);
  EXPECT_EQ(world.contact_pairs()[0].phase, ContactPhase::end);
}

TEST(ContactPairs, ObjectsInOrder) {
  World world;
  const ColliderId floor = world.add_collider(Plane{});
  const ObjectId plate =
      world.add_obstacle(grid(4, 4, 1), {}, {}, {.transform = {.translation = {0, 0.2, 0}}});
  const ObjectId sheet =
      world.add_cloth(grid(10, 10, 0.8f), {}, {.transform = {.translation = {0, 0.25, 0}}});
  const Vec3d grain[] = {{0, 0.4, 0}, {2, 0.1, 0}};
  const ObjectId grains = world.add_grains(grain, {.radius = 0.1f, .density = 500});
  world.track_contacts(true);
  for (int i = 0; i < 90; ++i) world.step(frame);
  const std::span<const ContactPair> pairs = world.contact_pairs();
  ASSERT_EQ(pairs.size(), 4u);
  EXPECT_EQ(pairs[0].object, plate);
  EXPECT_EQ(pairs[0].other, sheet);
  EXPECT_LT(pairs[0].normal.y, -0.9f);  // toward the plate
  EXPECT_EQ(pairs[1].object, plate);
  EXPECT_EQ(pairs[1].other, grains);  // one of them presses the sheet to the plate
  EXPECT_EQ(pairs[2].object, sheet);
  EXPECT_EQ(pairs[2].other, grains);
  EXPECT_LT(pairs[2].normal.y, -0.5f);
  EXPECT_EQ(pairs[3].object, grains);
  EXPECT_EQ(pairs[3].collider, floor);
  // The floor carries one grain: m g dt.
  const double weight = 0.5 * world.total_mass(grains) * 9.81 * frame;
  EXPECT_NEAR(pairs[3].impulse, weight, 0.02 * weight);
  EXPECT_NEAR(pairs[1].impulse + pairs[2].impulse, weight, 0.05 * weight);
  for (const ContactPair& pair : pairs) EXPECT_EQ(pair.phase, ContactPhase::persist);
  // The contacts of the last substep have the same ids.
  for (const ContactEvent& event : world.contacts()) {
    EXPECT_EQ(event.object_id, world.find_object(event.object));
    if (event.other_is_collider) {
      EXPECT_EQ(event.collider_id, world.find_collider(event.other));
    } else {
      EXPECT_EQ(event.other_id, world.find_object(event.other));
    }
  }
  // A body that is gone ends its pairs.
  world.remove(sheet);
  world.step(frame);
  std::size_t ended = 0;
  for (const ContactPair& pair : world.contact_pairs())
    ended += pair.phase == ContactPhase::end && (pair.object == sheet || pair.other == sheet) ? 1 : 0;
  EXPECT_EQ(ended, 2u);  // with plate and grains
}

TEST(ContactPairs, SleepersStayInContact) {
  World world({.sleeping = {.enabled = true}});
  const Vec3d grain[] = {{0, 0.1, 0}};
  const ObjectId ball = world.add_grains(grain, {.radius = 0.1f});
  world.add_collider(Plane{});
  world.track_contacts(true);
  for (int i = 0; i < 300 && !world.is_asleep(ball); ++i) world.step(frame);
  ASSERT_TRUE(world.is_asleep(ball));
  for (int i = 0; i < 10; ++i) {
    world.step(frame);
    ASSERT_EQ(world.contact_pairs().size(), 1u);
    EXPECT_EQ(world.contact_pairs()[0].phase, ContactPhase::persist);
  }
  world.teleport(ball, {.translation = {0, 1, 0}});
  world.step(frame);
  ASSERT_EQ(world.contact_pairs().size(), 1u);
  EXPECT_EQ(world.contact_pairs()[0].phase, ContactPhase::end);
}

TEST(ContactPairs, ASensorReportsAndDoesNotPush) {
  World with, without;
  ColliderId gate;
  for (World* world : {&with, &without}) {
    const Vec3d grain[] = {{0, 1, 0}};
    world->add_grains(grain, {.radius = 0.05f});
    world->add_cloth(grid(2, 2, 4), {},
                     {.transform = {.translation = {0, 2, 0}}});  // two triangles, corners far away
    if (world == &with)
      gate = world->add_collider(Box{.center = {0, 0.5f, 0.2f}, .half_extents = {0.3f, 0.1f, 0.3f}},
                                 {.sensor = true});
  }
  std::vector<std::pair<int, ContactPhase>> grain_events, cloth_events;
  for (int i = 0; i < 60; ++i) {
    with.step(frame), without.step(frame);
    for (const ContactPair& pair : with.contact_pairs()) {
      EXPECT_TRUE(pair.is_sensor);
      EXPECT_EQ(pair.collider, gate);
      if (pair.phase == ContactPhase::persist) continue;
      (with.kind(pair.object) == ObjectKind::grains ? grain_events : cloth_events)
          .emplace_back(i, pair.phase);
    }
  }
  EXPECT_EQ(with.hash(), without.hash());
  // From y = 1 the ball enters at 0.65 and leaves at 0.35: after 0.267 and 0.364 s. The sheet comes from 2 m at 0.6.
  ASSERT_EQ(grain_events.size(), 2u);
  EXPECT_EQ(grain_events[0].second, ContactPhase::begin);
  EXPECT_NEAR(grain_events[0].first + 1, 0.267 * 60, 1.1);
  EXPECT_EQ(grain_events[1].second, ContactPhase::end);
  EXPECT_NEAR(grain_events[1].first + 1, 0.364 * 60, 1.1);
  ASSERT_GE(cloth_events.size(), 1u);
  EXPECT_NEAR(cloth_events[0].first + 1, 0.534 * 60, 1.1);
  EXPECT_FALSE(with.ray_cast({0, 0.9f, 0.2f}, {0, -1, 0}, 1).found);
  EXPECT_TRUE(with.ray_cast({0, 0.9f, 0.2f}, {0, -1, 0}, 1, {.sensors = true}).found);
}

TEST(ContactPairs, AFailedStepReportsNothing) {
  World world;
  const Vec3d grain[] = {{0, 0.1, 0}};
  world.add_grains(grain, {.radius = 0.1f});
  world.add_collider(Plane{});
  world.track_contacts(true);
  for (int i = 0; i < 30; ++i) world.step(frame);
  ASSERT_EQ(world.contact_pairs().size(), 1u);
  const ForceFieldId field = world.add_force_field([](const Vec3f&, const Vec3f&, float, double) {
    return Vec3f{NAN, 0, 0};
  });
  EXPECT_FALSE(world.step(frame).ok());
  EXPECT_TRUE(world.contact_pairs().empty());
  world.remove(field);
  EXPECT_TRUE(world.step(frame).ok());
  ASSERT_EQ(world.contact_pairs().size(), 1u);
  EXPECT_EQ(world.contact_pairs()[0].phase, ContactPhase::persist);
}

TEST(UserData, BelongsToObjectsAndColliders) {
  World world;
  const ObjectId sheet = world.add_cloth(grid(2, 2, 1));
  const ColliderId floor = world.add_collider(Plane{});
  EXPECT_EQ(world.user_data(sheet), 0u);
  world.set_user_data(sheet, 0x123456789abcdef0u);
  world.set_user_data(floor, 7);
  world.set_collider(floor, Plane{.offset = 1}, {});
  world.step(frame);
  EXPECT_EQ(world.user_data(sheet), 0x123456789abcdef0u);
  EXPECT_EQ(world.user_data(floor), 7u);
  world.remove(sheet);
  expect_error([&] { (void)world.user_data(sheet); }, {"no object has the handle"});
  expect_error([&] { world.set_user_data(ColliderId{99}, 1); }, {"no collider has the handle"});
}

}  // namespace souple::test_world_contact_pairs
