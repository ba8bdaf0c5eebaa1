// Collision filters: groups, masks and the pair table, for every kind of contact.
#include "souple/contacts/contact_material.h"
#include "souple/geometry/builders.h"
#include "souple/world/world.h"

#include <algorithm>
#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace souple::test_world_groups {

constexpr float floor_height = -1;  // of the floor below all objects [m]

/// The falling object: from y = 0.1 onto an object or collider at y = 0.
enum class Falling { cloth, rope, grains, lattice_body };
/// The object or collider below.
enum class Below { collider, cloth, obstacle, grains };

ObjectOptions named(const char* name, CollisionFilter filter) {
  ObjectOptions options;
  options.name = name;
  options.collision_groups = filter.groups;
  options.collision_mask = filter.mask;
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
  World world({.substeps = 5});
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
    const std::vector<Vec3d> center{{x, 0.1, 0.003}};
    grains.push_back(world.add_grains(center, {.radius = 0.02f}));
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
    ObjectOptions options;
    options.name = "sheet";
    options.self_collision = self_collision ? SelfCollision::surfaces : SelfCollision::off;
    options.transform = {{0, 0.35, 0}, Quatd::from_euler_xyz({0.2, 0, 1.5}), 1};
    world.add_cloth(grid(11, 11, 0.6), {}, options);
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
  const std::vector<Vec3d> centers{{0, -0.9, 0}, {0, -0.8, 0}};
  const ObjectId grains =
      world.add_grains(centers, {.radius = 0.05f}, named("grains", {.groups = 1, .mask = 2}));
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

}  // namespace souple::test_world_groups
