// Foam of a world's fluids: its origin, its motion, and its collisions.

#include "souple/souple.h"
#include "tests/expect_error.h"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

namespace souple::test_physics_fluid_foam {

constexpr double d = 0.04;  // m
constexpr FluidMaterial foaming{.spacing = 0.04f, .foam = 1};

/// Walls at the ends of a tank from -length / 2 to length / 2, 8 spacings wide.
void add_tank(World& world, double length, double height = 100) {
  const auto end = static_cast<float>(-length / 2), side = static_cast<float>(-4 * d);
  world.add_collider(Plane{});
  world.add_collider(Plane{{0, -1, 0}, static_cast<float>(-height)});
  world.add_collider(Plane{{1, 0, 0}, end});
  world.add_collider(Plane{{-1, 0, 0}, end});
  world.add_collider(Plane{{0, 0, 1}, side});
  world.add_collider(Plane{{0, 0, -1}, side});
}

ObjectId add_block(World& world, const Vec3d& lo, const Vec3d& hi, const FluidMaterial& material = foaming,
                   const ObjectOptions& options = {}) {
  return world.add_fluid(fill({lo.x, lo.y, -4 * d}, {hi.x, hi.y, 4 * d}, d), material, options);
}

/// A column that falls, or is thrown, and hits the opposite end of its tank.
World dam_break(const Settings& settings = {.substeps = 8}, float speed = 0) {
  World world(settings);
  add_tank(world, 1.6);
  add_block(world, {-0.8, 0, 0}, {-0.4, 0.8, 0}, foaming, {.velocity = {speed, 0, 0}});
  return world;
}

std::size_t count(const World& world, FoamKind kind) {
  const auto kinds = world.foam().kinds;
  return static_cast<std::size_t>(std::count(kinds.begin(), kinds.end(), kind));
}

bool equal(const FoamView& a, const FoamView& b) {
  return std::equal(a.positions.begin(), a.positions.end(), b.positions.begin(), b.positions.end()) &&
         std::equal(a.velocities.begin(), a.velocities.end(), b.velocities.begin(), b.velocities.end()) &&
         std::equal(a.kinds.begin(), a.kinds.end(), b.kinds.begin(), b.kinds.end());
}

TEST(FluidFoam, ACalmPoolMakesNone) {
  World world({.substeps = 6});
  add_tank(world, 0.8);
  add_block(world, {-0.4, 0, 0}, {0.4, 0.32, 0});
  for (int frame = 0; frame < 120; ++frame) {
    const FluidReport& report = world.step(1.0 / 60).fluid;
    ASSERT_EQ(report.spray + report.foam + report.bubbles, 0) << frame;
  }
  EXPECT_TRUE(world.foam().positions.empty());
}

// All three kinds appear; then the water calms down, and all dissolve.
TEST(FluidFoam, ABreakingWaveFoamsAndTheFoamDissolves) {
  World world = dam_break({.substeps = 8}, 4);
  std::size_t spray = 0, foam = 0, bubbles = 0;
  for (int frame = 0; frame < 90; ++frame) {
    const FluidReport& report = world.step(1.0 / 60).fluid;
    ASSERT_EQ(report.spray, count(world, FoamKind::spray));
    ASSERT_EQ(report.foam, count(world, FoamKind::foam));
    ASSERT_EQ(report.bubbles, count(world, FoamKind::bubble));
    spray = std::max(spray, report.spray);
    foam = std::max(foam, report.foam);
    bubbles = std::max(bubbles, report.bubbles);
  }
  EXPECT_GT(spray, 50);
  EXPECT_GT(foam, 200);
  EXPECT_GT(bubbles, 50);
  const std::size_t most = spray + foam + bubbles;
  for (int frame = 0; frame < 420; ++frame) world.step(1.0 / 60);
  EXPECT_LT(world.foam().positions.size(), most / 50);
}

// It has no influence on other motion, and does not exist without a foaming material.
TEST(FluidFoam, IsPassive) {
  World with = dam_break(), without = dam_break();
  FluidMaterial plain = foaming;
  plain.foam = 0;
  without.set_material(without.objects()[0], plain);
  for (int frame = 0; frame < 60; ++frame) with.step(1.0 / 60), without.step(1.0 / 60);
  EXPECT_EQ(with.hash(), without.hash());
  EXPECT_GT(with.foam().positions.size(), 100);
  EXPECT_EQ(without.foam().positions.size(), 0);
}

// From one step to the next spray falls freely, bubbles rise, foam stays on top.
TEST(FluidFoam, SprayFallsBubblesRiseFoamFloats) {
  World world = dam_break({.substeps = 8}, 4);
  for (int frame = 0; frame < 30; ++frame) world.step(1.0 / 60);
  FluidMaterial quiet = foaming;
  quiet.foam = 0;  // no new particles; existing ones remain
  world.set_material(world.objects()[0], quiet);
  std::size_t falling = 0, checked = 0;
  double rise = 0, water = 0;
  std::size_t bubbles = 0;
  for (int frame = 0; frame < 30; ++frame) {
    const FoamView foam = world.foam();
    const std::vector<Vec3f> before(foam.velocities.begin(), foam.velocities.end());
    const std::vector<FoamKind> kinds(foam.kinds.begin(), foam.kinds.end());
    world.step(1.0 / 60);
    if (world.foam().positions.size() == before.size())  // none dissolved: the order is unchanged
      for (std::size_t k = 0; k < before.size(); ++k)
        if (kinds[k] == FoamKind::spray && world.foam().kinds[k] == FoamKind::spray) {
          ++checked;
          const Vec3f change = world.foam().velocities[k] - before[k];
          if (length(change - Vec3f(0, -9.81f / 60, 0)) < 1e-4f) ++falling;
        }
  }
  ASSERT_GT(checked, 100);
  EXPECT_GT(double(falling), 0.9 * double(checked));  // the others hit a wall
  const auto positions = world.positions(world.objects()[0]);
  for (std::size_t k = 0; k < world.foam().positions.size(); ++k) {
    if (world.foam().kinds[k] != FoamKind::bubble) continue;
    float nearest = 1e30f;
    std::size_t at = 0;
    for (std::size_t i = 0; i < positions.size(); ++i) {
      const float distance = length(positions[i] - world.foam().positions[k]);
      if (distance < nearest) nearest = distance, at = i;
    }
    ++bubbles;
    rise += double{world.foam().velocities[k].y};
    water += double{world.velocities(world.objects()[0])[at].y};
  }
  ASSERT_GT(bubbles, 20);
  EXPECT_NEAR((rise - water) / double(bubbles), 2 * 9.81 / 60, 0.1);
}

/// A wave that hits a thin plate across the tank: a collider, or another kind of object.
template <class AddPlate>
void expect_nothing_behind_a_plate(const AddPlate& add_plate) {
  World world({.substeps = 8});
  add_tank(world, 2, 1);
  add_plate(world);
  add_block(world, {-1, 0, 0}, {-0.6, 0.8, 0}, foaming, {.velocity = {4, 0, 0}});
  std::size_t most = 0;
  for (int frame = 0; frame < 60; ++frame) {
    world.step(1.0 / 60);
    for (const Vec3f& x : world.foam().positions) {
      ASSERT_LT(x.x, 0.1) << frame;
      ASSERT_GT(std::min({x.x + 1, x.y, 1 - x.y, 0.16f + x.z, 0.16f - x.z}), -1e-4f) << frame;
    }
    most = std::max(most, world.foam().positions.size());
  }
  EXPECT_GT(most, 500);
}

TEST(FluidFoam, StaysBeforeACollider) {
  expect_nothing_behind_a_plate([](World& world) {
    world.add_collider(Box{{0, 0.5f, 0}, {0.005f, 0.5f, 0.2f}});
  });
}

TEST(FluidFoam, StaysBeforeAWallThatMoves) {
  expect_nothing_behind_a_plate([](World& world) {
    world.add_collider(Box{{0, 0.5f, 0}, {0.005f, 0.5f, 0.2f}},
                       {.motion = ColliderMotion::callback([](double t) {
                          return Transform{.translation = {-0.2 + 0.2 * std::cos(12 * t), 0, 0}};
                        })});
  });
}

TEST(FluidFoam, StaysBeforeAnObstacle) {
  expect_nothing_behind_a_plate([](World& world) {
    TriangleMesh plate = grid(2, 2, 2.4);
    world.add_obstacle(plate, {}, {}, {.transform = {.rotation = Quatd::from_axis_angle({0, 0, 1}, pi / 2)}});
  });
}

// Pinned at its corners, it hangs across the tank and bulges.
TEST(FluidFoam, StaysBeforeCloth) {
  expect_nothing_behind_a_plate([](World& world) {
    const ObjectId cloth =
        world.add_cloth(grid(21, 21, 2.4), material::denim,
                        {.transform = {.rotation = Quatd::from_axis_angle({0, 0, 1}, pi / 2)}});
    world.pin(cloth, in_box({-1, -2, -2}, {1, 2, 2}));
  });
}

TEST(FluidFoam, IsBounded) {
  World world = dam_break({.substeps = 8, .fluid = {.foam = {.max_particles = 300}}}, 4);
  std::size_t most = 0;
  for (int frame = 0; frame < 60; ++frame) {
    world.step(1.0 / 60);
    most = std::max(most, world.foam().positions.size());
  }
  EXPECT_EQ(most, 300);
}

TEST(FluidFoam, GoesOnFromASnapshot) {
  World a = dam_break(), b = dam_break();
  for (int frame = 0; frame < 40; ++frame) a.step(1.0 / 60);
  ASSERT_GT(a.foam().positions.size(), 100);
  const Snapshot snapshot = a.snapshot();
  b.restore(snapshot);
  EXPECT_TRUE(equal(a.foam(), b.foam()));
  for (int frame = 0; frame < 15; ++frame) a.step(1.0 / 60), b.step(1.0 / 60);
  EXPECT_TRUE(equal(a.foam(), b.foam()));
  a.restore(snapshot);
  for (int frame = 0; frame < 15; ++frame) a.step(1.0 / 60);
  EXPECT_TRUE(equal(a.foam(), b.foam()));
}

TEST(FluidFoam, IsTheSameFarFromTheOrigin) {
  std::size_t foam[2];
  double height[2] = {};
  for (const int far : {0, 1}) {
    World world({.substeps = 8});
    world.add_collider(Plane{});
    const double x = far * 3000.0;
    world.add_collider(Box{{static_cast<float>(x) + 0.9f, 1, 0}, {0.1f, 1, 0.4f}});
    world.add_fluid(fill({-0.8, 0, -0.16}, {-0.4, 0.8, 0.16}, d), foaming,
                    {.transform = {.translation = {x + 0.8, 0, 0}}, .velocity = {3, 0, 0}});
    for (int frame = 0; frame < 30; ++frame) world.step(1.0 / 60);
    foam[far] = world.foam().positions.size();
    for (const Vec3f& at : world.foam().positions) height[far] += double{at.y} / double(foam[far]);
  }
  EXPECT_GT(foam[0], 500);
  EXPECT_NEAR(double(foam[1]) / double(foam[0]), 1, 0.1);
  EXPECT_NEAR(height[1] / height[0], 1, 0.1);
}

TEST(FluidFoam, WrongNumbersAreErrors) {
  World world;
  expect_error([&] { world.set_settings({.fluid = {.foam = {.life = {3, 2}}}}); }, {"fluid.foam.life", "3"});
  expect_error([&] { world.set_settings({.fluid = {.foam = {.drag = 0}}}); }, {"fluid.foam.drag"});
  FluidMaterial material = foaming;
  material.foam = -1;
  expect_error([&] { add_block(world, {0, 0, 0}, {0.1, 0.1, 0}, material); }, {"foam", "-1"});
}

}  // namespace souple::test_physics_fluid_foam
