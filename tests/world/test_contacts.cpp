#include "souple/contacts/contact_material.h"
#include "tests/expect_error.h"
#include "tests/world/scene.h"

#include <algorithm>
#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace souple::test_world_contacts {

constexpr double dt = 1.0 / 60;

TEST(ContactPairs, BeginPersistAndEnd) {
  World world;
  const ObjectId ball = world.add_grains(std::vector<Vec3d>{{0, 0.3, 0}}, {.radius = 0.1f, .density = 1000});
  const ColliderId floor = world.add_collider(Plane{});
  world.track_contacts(true);
  int begins = 0, persists = 0;
  double impulse = 0;
  for (int i = 0; i < 60; ++i) {
    world.step(dt);
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
  world.step(dt);
  ASSERT_EQ(world.contact_pairs().size(), 1u);
  EXPECT_EQ(world.contact_pairs()[0].phase, ContactPhase::end);
  EXPECT_EQ(world.contact_pairs()[0].impulse, 0);
  world.step(dt);
  EXPECT_TRUE(world.contact_pairs().empty());
}

// A ball that bounces within a step touches in that step.
TEST(ContactPairs, ABounceWithinAStepIsSeen) {
  World world({.substeps = 10});
  const Vec3d grain[] = {{0, 0.3, 0}};
  const ObjectId ball = world.add_grains(grain, {.radius = 0.1f, .friction = 0, .restitution = 1});
  world.add_collider(Plane{}, {.friction = 0, .restitution = 1});
  world.set_velocities(ball, std::vector<Vec3f>{{0, -20, 0}});
  world.track_contacts(true);
  world.step(dt);
  EXPECT_GT(world.velocities(ball)[0].y, 10);
  EXPECT_TRUE(world.contacts().empty());
  ASSERT_EQ(world.contact_pairs().size(), 1u);
  EXPECT_EQ(world.contact_pairs()[0].phase, ContactPhase::begin);
  world.step(dt);
  ASSERT_EQ(world.contact_pairs().size(), 1u);
  EXPECT_EQ(world.contact_pairs()[0].phase, ContactPhase::end);
}

TEST(ContactPairs, ObjectsInOrder) {
  World world;
  const ColliderId floor = world.add_collider(Plane{});
  const ObjectId plate = world.add_obstacle(grid(4, 4, 1), {}, {}, at(0, 0.2, 0));
  const ObjectId sheet = world.add_cloth(grid(10, 10, 0.8f), {}, at(0, 0.25, 0));
  const Vec3d grain[] = {{0, 0.4, 0}, {2, 0.1, 0}};
  const ObjectId grains = world.add_grains(grain, {.radius = 0.1f, .density = 500});
  world.track_contacts(true);
  for (int i = 0; i < 90; ++i) world.step(dt);
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
  const double weight = 0.5 * world.total_mass(grains) * 9.81 * dt;
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
  world.step(dt);
  std::size_t ended = 0;
  for (const ContactPair& pair : world.contact_pairs())
    ended += pair.phase == ContactPhase::end && (pair.object == sheet || pair.other == sheet) ? 1 : 0;
  EXPECT_EQ(ended, 2u);  // with plate and grains
}

TEST(ContactPairs, SleepersStayInContact) {
  World world({.sleeping = {.enabled = true}});
  const ObjectId ball = world.add_grains(std::vector<Vec3d>{{0, 0.1, 0}}, {.radius = 0.1f});
  world.add_collider(Plane{});
  world.track_contacts(true);
  for (int i = 0; i < 300 && !world.is_asleep(ball); ++i) world.step(dt);
  ASSERT_TRUE(world.is_asleep(ball));
  for (int i = 0; i < 10; ++i) {
    world.step(dt);
    ASSERT_EQ(world.contact_pairs().size(), 1u);
    EXPECT_EQ(world.contact_pairs()[0].phase, ContactPhase::persist);
  }
  world.teleport(ball, {.translation = {0, 1, 0}});
  world.step(dt);
  ASSERT_EQ(world.contact_pairs().size(), 1u);
  EXPECT_EQ(world.contact_pairs()[0].phase, ContactPhase::end);
}

TEST(ContactPairs, ASensorReportsAndDoesNotPush) {
  const Settings vacuum{.wind = {.air_density = 0}};
  World with(vacuum), without(vacuum);
  ColliderId gate;
  for (World* world : {&with, &without}) {
    world->add_grains(std::vector<Vec3d>{{0, 1, 0}}, {.radius = 0.05f});
    world->add_cloth(grid(2, 2, 4), {}, at(0, 2, 0));  // two triangles, corners far away
    if (world == &with)
      gate = world->add_collider(Box{.center = {0, 0.5f, 0.2f}, .half_extents = {0.3f, 0.1f, 0.3f}},
                                 {.sensor = true});
  }
  std::vector<std::pair<int, ContactPhase>> grain_events, cloth_events;
  for (int i = 0; i < 60; ++i) {
    with.step(dt), without.step(dt);
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
  world.add_grains(std::vector<Vec3d>{{0, 0.1, 0}}, {.radius = 0.1f});
  world.add_collider(Plane{});
  world.track_contacts(true);
  for (int i = 0; i < 30; ++i) world.step(dt);
  ASSERT_EQ(world.contact_pairs().size(), 1u);
  const ForceFieldId field = world.add_force_field([](const Vec3f&, const Vec3f&, float, double) {
    return Vec3f{NAN, 0, 0};
  });
  EXPECT_FALSE(world.step(dt).ok());
  EXPECT_TRUE(world.contact_pairs().empty());
  world.remove(field);
  EXPECT_TRUE(world.step(dt).ok());
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
  world.step(dt);
  EXPECT_EQ(world.user_data(sheet), 0x123456789abcdef0u);
  EXPECT_EQ(world.user_data(floor), 7u);
  world.remove(sheet);
  expect_error([&] { (void)world.user_data(sheet); }, {"no object has the handle"});
  expect_error([&] { world.set_user_data(ColliderId{99}, 1); }, {"no collider has the handle"});
}

// Collision filters: groups, masks and the pair table, for every kind of contact.

constexpr float floor_height = -1;  // of the floor below all objects [m]

/// The falling object: from y = 0.1 onto an object or collider at y = 0.
enum class Falling { cloth, rope, grains, lattice_body };
/// The object or collider below.
enum class Below { collider, cloth, obstacle, grains };

ObjectOptions named(const char* name, CollisionFilter filter) {
  ObjectOptions options{.name = name, .collision_groups = filter.groups, .collision_mask = filter.mask};
  return options;
}

std::vector<Vec3d> layer_of_grains(double height) {
  std::vector<Vec3d> centers;
  for (int i = -6; i <= 6; ++i)
    for (int k = -6; k <= 6; ++k) centers.push_back({0.02 * i, height, 0.02 * k});
  return centers;
}

ObjectId add_falling(World& world, Falling what, CollisionFilter filter) {
  ObjectOptions options = named("falling", filter);
  options.transform.translation = {0.003, 0.1, 0.004};
  switch (what) {
    case Falling::cloth:
      return world.add_cloth(grid(7, 7, 0.15), {}, options);
    case Falling::rope:
      return world.add_rope(std::vector<Vec3d>{{-0.08, 0, 0}, {0.08, 0, 0}}, 12, {.radius = 0.006f}, options);
    case Falling::grains:
      return world.add_grains(std::vector<Vec3d>{{0, 0, 0}}, {.radius = 0.02f}, options);
    case Falling::lattice_body:
      break;
  }
  return world.add_soft_body(sphere(2, 0.05), {}, {.cells = 100}, options);
}

void add_below(World& world, Below what, CollisionFilter filter) {
  if (what == Below::collider) {
    world.add_collider(Box{.half_extents = {0.3f, 0.02f, 0.3f}},
                       {.name = "below", .collision_groups = filter.groups, .collision_mask = filter.mask});
    return;
  }
  const ObjectOptions options = named("below", filter);
  ObjectId id{};
  if (what == Below::cloth) id = world.add_cloth(grid(13, 13, 0.3), {}, options);
  if (what == Below::grains) id = world.add_grains(layer_of_grains(0), {.radius = 0.01f}, options);
  if (what == Below::obstacle) {
    world.add_obstacle(grid(13, 13, 0.3), {}, {}, options);
  } else {
    world.pin(id, all());
  }
}

/// Lowest point of the falling object half a second later: about 0 if it was stopped, below -1 if not.
float lowest(World& world, ObjectId id) {
  for (int frame = 0; frame < 30; ++frame) EXPECT_TRUE(world.step(1.0 / 60).ok());
  float y = 1;
  for (const Vec3f& x : world.positions(id)) y = std::min(y, x.y);
  return y;
}

bool passes(Falling falling, CollisionFilter a, Below below, CollisionFilter b, bool collide = true) {
  World world({.substeps = 5, .wind = {.air_density = 0}});
  const ObjectId id = add_falling(world, falling, a);
  add_below(world, below, b);
  world.set_collide("below", "falling", collide);
  const float y = lowest(world, id);
  EXPECT_TRUE(y < -0.9f || y > -0.06f) << y;
  return y < -0.9f;
}

struct Case {
  Falling falling;
  Below below;
};

// Surfaces, balls and analytic colliders: the three kinds of contact.
const Case cases[] = {
    {Falling::cloth, Below::collider},        {Falling::rope, Below::collider},
    {Falling::grains, Below::collider},       {Falling::cloth, Below::cloth},
    {Falling::cloth, Below::obstacle},        {Falling::rope, Below::obstacle},
    {Falling::grains, Below::cloth},          {Falling::cloth, Below::grains},
    {Falling::grains, Below::grains},         {Falling::rope, Below::grains},
    {Falling::lattice_body, Below::obstacle},
};

TEST(Groups, TwoObjectsCollideWhenEachMaskHasTheOther) {
  for (const Case& c : cases) {
    SCOPED_TRACE(std::to_string(int(c.falling)) + " on " + std::to_string(int(c.below)));
    EXPECT_FALSE(passes(c.falling, {}, c.below, {}));
    // Separate bits: the engine reserves none of them.
    EXPECT_FALSE(passes(c.falling, {1u << 31, 2}, c.below, {2, 1u << 31}));
    EXPECT_TRUE(passes(c.falling, {1, ~0u}, c.below, {1, ~1u})) << "only one of them wants to";
    EXPECT_TRUE(passes(c.falling, {1, ~1u}, c.below, {1, ~0u})) << "only the other one wants to";
    EXPECT_TRUE(passes(c.falling, {0, ~0u}, c.below, {})) << "in no group";
  }
}

TEST(Groups, ThePairTableKeepsTwoNamesApart) {
  for (const Case& c : cases) {
    SCOPED_TRACE(std::to_string(int(c.falling)) + " on " + std::to_string(int(c.below)));
    EXPECT_TRUE(passes(c.falling, {}, c.below, {}, false));
  }
}

TEST(Groups, OthersStillCollide) {
  World world({.substeps = 5});
  add_below(world, Below::obstacle, {});
  std::vector<ObjectId> grains;
  for (const double x : {-0.1, 0.0, 0.1}) {
    grains.push_back(world.add_grains(std::vector<Vec3d>{{x, 0.1, 0.003}}, {.radius = 0.02f}));
  }
  world.set_collide("grains2", "below", false);
  lowest(world, grains[0]);
  EXPECT_GT(world.positions(grains[0])[0].y, 0);
  EXPECT_LT(world.positions(grains[1])[0].y, -0.9f);
  EXPECT_GT(world.positions(grains[2])[0].y, 0);
}

TEST(Groups, MayChangeWhileItRuns) {
  World world({.substeps = 5});
  const ObjectId grain = add_falling(world, Falling::grains, {});
  add_below(world, Below::cloth, {2, ~0u});
  EXPECT_GT(lowest(world, grain), 0);
  world.set_collision_groups(grain, 4, ~2u);
  EXPECT_EQ(world.collision_groups(grain), 4u);
  EXPECT_EQ(world.collision_mask(grain), ~2u);
  EXPECT_LT(lowest(world, grain), -0.9f);

  World paired({.substeps = 5});
  const ObjectId other = add_falling(paired, Falling::grains, {});
  add_below(paired, Below::collider, {});
  EXPECT_GT(lowest(paired, other), 0);
  paired.set_collide("falling", "below", false);
  EXPECT_LT(lowest(paired, other), -0.9f);
}

TEST(Groups, ACollidersMayChangeToo) {
  World world({.substeps = 5});
  const ObjectId grain = add_falling(world, Falling::grains, {});
  add_below(world, Below::collider, {});
  EXPECT_GT(lowest(world, grain), 0);
  const ColliderId below = world.find_collider("below");
  ColliderOptions options = world.collider_options(below);
  options.collision_mask = 2;
  world.set_collider(below, world.shape(below), options);
  EXPECT_LT(lowest(world, grain), -0.9f);
}

// Two grains above each other on the floor: with self-collision they stack, without they coincide.
TEST(Groups, TheNameOfAnObjectTwiceIsItsSelfCollision) {
  for (const bool collide : {true, false}) {
    World world({.substeps = 5});
    world.add_collider(Plane{.offset = floor_height});
    const std::vector<Vec3d> centers{{0, -0.9, 0}, {0, -0.8, 0}};
    const ObjectId grains = world.add_grains(centers, {.radius = 0.05f, .friction = 1});
    world.set_collide("grains", "grains", collide);
    lowest(world, grains);
    EXPECT_NEAR(world.positions(grains)[1].y, collide ? -0.85f : -0.95f, 0.005f);
  }
}

TEST(Groups, SelfCollisionOfAClothIsSwitchedOffByThePair) {
  const auto folded = [](bool self_collision, bool collide) {
    World world({.substeps = 3});
    world.add_cloth(grid(11, 11, 0.6), {},
                    {.name = "sheet",
                     .transform = {{0, 0.35, 0}, Quatd::from_euler_xyz({0.2, 0, 1.5}), 1},
                     .self_collision = self_collision ? SelfCollision::surfaces : SelfCollision::off});
    world.add_collider(Plane{});
    world.set_collide("sheet", "sheet", collide);
    for (int frame = 0; frame < 60; ++frame) world.step(1.0 / 60);
    return world.hash();
  };
  EXPECT_EQ(folded(true, false), folded(false, true));
  EXPECT_NE(folded(true, true), folded(false, true));
  EXPECT_EQ(folded(false, true), folded(false, false)) << "true does not switch it on";
}

TEST(Groups, MasksDoNotStopAnObjectFromCollidingWithItself) {
  World world({.substeps = 5});
  world.add_collider(Plane{.offset = floor_height}, {.collision_groups = 2});
  const ObjectId grains = world.add_grains(std::vector<Vec3d>{{0, -0.9, 0}, {0, -0.8, 0}}, {.radius = 0.05f},
                                           named("grains", {.groups = 1, .mask = 2}));
  lowest(world, grains);
  EXPECT_NEAR(world.positions(grains)[1].y, -0.85f, 0.005f);
}

TEST(Groups, PickingFindsWhatMeetsNothing) {
  World world;
  const ObjectId cloth = world.add_cloth(grid(3, 3, 1), {}, named("ghost", {.groups = 0, .mask = 0}));
  const Hit hit = world.ray_cast({0.1f, 1, 0.1f}, {0, -1, 0});
  ASSERT_TRUE(hit.found);
  EXPECT_EQ(hit.object, cloth);
  EXPECT_TRUE(world.closest_point({0, 0.1f, 0}).found);
}

}  // namespace souple::test_world_contacts
