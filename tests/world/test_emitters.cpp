#include "tests/expect_error.h"
#include "tests/world/scene.h"

#include <cmath>
#include <map>
#include <vector>

#include <gtest/gtest.h>

namespace souple::test_world_emitters {

constexpr float d = 0.05f;  // m
constexpr FluidMaterial water{.spacing = d, .density = 1000};
const Emitter nozzle{.position = {0, 2, 0}, .direction = {0, -1, 0}, .radius = 0.1f, .speed = 1.5f};
// Points of a square lattice within two pitches of a lattice point, and of the center of four points.
constexpr std::size_t in_layers[] = {13, 12};
constexpr double in_layer = 12.5;

ObjectId add_empty(World& world, std::uint32_t most) {
  return world.add_fluid(std::vector<Vec3d>{}, water, {.name = "water", .max_particles = most});
}

World weightless() {
  return World({.substeps = 2, .gravity = {}});
}

TEST(Emitters, BringTheirFlow) {
  World world = weightless();
  const ObjectId fluid = add_empty(world, 10000);
  world.add_emitter(fluid, nozzle);
  std::size_t emitted = 0;
  for (int frame = 0; frame < 60; ++frame) emitted += world.step(1.0 / 60).fluid.emitted;
  // N d^2 speed per second, in volumes d^3; the first layer leaves at once.
  const double layers = 1.5 / 0.05;
  EXPECT_NEAR(static_cast<double>(emitted), layers * in_layer, 13.01);
  EXPECT_EQ(world.positions(fluid).size(), emitted);
  EXPECT_NEAR(world.total_mass(fluid), static_cast<double>(emitted) * 1000 * 0.05 * 0.05 * 0.05, 1e-3);
}

TEST(Emitters, ASteadyJetIsOfLayersASpacingApartWhateverTheStep) {
  World world = weightless();
  const ObjectId fluid = add_empty(world, 10000);
  world.add_emitter(fluid, nozzle);
  for (const double dt : {0.01, 0.023, 0.004, 0.05, 0.017}) world.step(dt);
  std::map<int, int> layers;  // key: distance from the nozzle in spacings of a layer that left at 0
  const double front = 1.5 * world.time();
  for (const Vec3f& x : world.positions(fluid)) {
    const double behind = (static_cast<double>(x.y) - (2 - front)) / 0.05;
    EXPECT_NEAR(behind, std::round(behind), 0.05);
    ++layers[static_cast<int>(std::round(behind))];
  }
  ASSERT_GE(layers.size(), 3u);
  for (const auto& [layer, count] : layers) EXPECT_EQ(count, static_cast<int>(in_layers[layer % 2])) << layer;
  for (const Vec3f& v : world.velocities(fluid)) EXPECT_NEAR(v.y, -1.5f, 0.05f);
}

TEST(Emitters, StopAtTheirEndAndAtTheMostThatTheFluidMayHave) {
  World world = weightless();
  const ObjectId timed = add_empty(world, 10000);
  Emitter short_one = nozzle;
  short_one.start = 0.1, short_one.end = 0.2;
  world.add_emitter(timed, short_one);
  const ObjectId full = world.add_fluid(std::vector<Vec3d>{}, water, {.name = "full", .max_particles = 20});
  Emitter far_off = nozzle;
  far_off.position = {5, 2, 0};
  world.add_emitter(full, far_off);
  std::size_t held_back = 0;
  for (int frame = 0; frame < 60; ++frame) held_back += world.step(1.0 / 60).fluid.held_back;
  EXPECT_EQ(world.positions(timed).size(), 13u + 12 + 13);  // at 0.1, 0.1333, 0.1667 s
  EXPECT_EQ(world.positions(full).size(), 20u);
  EXPECT_GT(held_back, 100u);
}

TEST(Emitters, HoldBackWhatWouldBeWithinOtherFluid) {
  World world = weightless();
  const ObjectId fluid = world.add_fluid(fill(Vec3d{-0.325, 1.7, -0.325}, Vec3d{0.325, 2.3, 0.325}, 0.05),
                                         water, {.max_particles = 5000});
  world.add_emitter(fluid, nozzle);
  const FluidReport& report = world.step(1e-4).fluid;
  EXPECT_GT(report.held_back, 0u);
  EXPECT_EQ(report.emitted, 0u);
}

TEST(Emitters, GiveTheVelocityOfWhatCarriesThem) {
  World world = weightless();
  const ObjectId fluid = add_empty(world, 1000);
  Emitter carried = nozzle;
  carried.motion = ColliderMotion::keyframes({{0, {}, {}}, {1, {3, 0, 0}, {}}});
  carried.radius = 0;
  world.add_emitter(fluid, carried);
  for (int frame = 0; frame < 10; ++frame) world.step(1.0 / 60);
  ASSERT_GT(world.positions(fluid).size(), 3u);
  EXPECT_NEAR(world.velocities(fluid)[0].x, 3, 0.01f);
  EXPECT_NEAR(world.velocities(fluid)[0].y, -1.5f, 0.01f);
}

TEST(Drains, TakeWhatIsInThemAndKeepTheOrderOfTheRest) {
  World world = weightless();
  std::vector<Vec3d> points(10, {0, 1, 0});
  for (std::size_t i = 0; i < 10; ++i) points[i].x = 0.2 * double(i);
  const ObjectId fluid = world.add_fluid(points, water);
  world.add_drain({.shape = Box{{0.5f, 1, 0}, {0.21f, 0.1f, 0.1f}}});  // points 2, 3 (0.4, 0.6)
  const StepReport& report = world.step(1e-3);
  EXPECT_EQ(report.fluid.drained, 2u);
  const auto x = world.positions(fluid);
  ASSERT_EQ(x.size(), 8u);
  const float left[] = {0, 0.2f, 0.8f, 1.0f, 1.2f, 1.4f, 1.6f, 1.8f};
  for (std::size_t i = 0; i < 8; ++i) EXPECT_NEAR(x[i].x, left[i], 1e-5f);
  EXPECT_EQ(world.pressures(fluid).size(), 8u);
}

TEST(Drains, TakeNoMoreThanTheirRate) {
  World world = weightless();
  const ObjectId fluid = world.add_fluid(fill(Vec3d{}, Vec3d{1, 1, 1}, 0.05), water);
  const std::size_t before = world.positions(fluid).size();
  world.add_drain({.shape = Plane{{0, 1, 0}, 2}, .rate = 0.02f});
  for (int frame = 0; frame < 60; ++frame) world.step(1.0 / 60);
  const double taken = static_cast<double>(before - world.positions(fluid).size()) * 0.05 * 0.05 * 0.05;
  EXPECT_NEAR(taken, 0.02, 0.001);
}

TEST(Drains, AFluidThatHasNothingLeftIsStillThere) {
  World world({.substeps = 2});
  const ObjectId fluid =
      world.add_fluid(fill(Vec3d{}, Vec3d{0.2, 0.2, 0.2}, 0.05), water, {.max_particles = 500});
  const ObjectId other = world.add_grains(std::vector<Vec3d>{{3, 0, 0}});
  world.add_drain({.shape = Plane{{0, 1, 0}, 1}});
  for (int frame = 0; frame < 3; ++frame) EXPECT_TRUE(world.step(1.0 / 60).ok());
  EXPECT_TRUE(world.positions(fluid).empty());
  EXPECT_EQ(world.total_mass(fluid), 0);
  EXPECT_EQ(world.center_of_mass(fluid), Vec3d{});
  world.remove(fluid);
  EXPECT_TRUE(world.step(1.0 / 60).ok());
  EXPECT_EQ(world.positions(other).size(), 1u);
}

// A jet falls through a net of obstacle triangles onto cloth and runs off into a drain.
World running() {
  World world({.substeps = 6});
  const ObjectId fluid = add_empty(world, 600);
  world.add_emitter(fluid, nozzle);
  world.add_obstacle(grid(2, 2, 0.5), {}, {}, {.name = "slab", .transform = {.translation = {0.3, 1.2, 0}}});
  const ObjectId sheet = world.add_cloth(grid(12, 12, 1.2), {}, at(0, 0.6, 0));
  world.pin(sheet, in_box({-0.61f, 0.5f, -0.61f}, {-0.59f, 0.7f, 0.61f}));
  world.add_drain({.shape = Plane{{0, 1, 0}, -0.5f}});
  return world;
}

TEST(Emitters, TheSameAfterARestore) {
  expect_resumes(running, 0.75, 0.75);
  World world = running();
  run(world, 1.5);
  EXPECT_LE(world.positions(world.find_object("water")).size(), 600u);
}

TEST(Emitters, BadOnesAreErrors) {
  World world;
  const ObjectId fluid = add_empty(world, 100);
  const ObjectId grains = world.add_grains(std::vector<Vec3d>{{}});
  const auto with = [](auto change) {
    Emitter bad = nozzle;
    change(bad);
    return bad;
  };
  expect_error([&] { world.add_emitter(grains, nozzle); }, {"expected a fluid"});
  expect_error([&] { world.add_emitter(fluid, with([](Emitter& e) { e.direction = {}; })); }, {"direction"});
  expect_error([&] { world.add_emitter(fluid, with([](Emitter& e) { e.speed = 0; })); }, {"speed"});
  expect_error([&] { world.add_emitter(fluid, with([](Emitter& e) { e.radius = NAN; })); }, {"radius"});
  expect_error([&] { world.add_emitter(fluid, with([](Emitter& e) { e.radius = 1000; })); }, {"a layer"});
  expect_error([&] { world.add_emitter(fluid, with([](Emitter& e) { e.end = -1; })); },
               {"an end not before"});
  expect_error([&] { world.add_drain({.shape = Sphere{{}, -1}}); }, {"radius"});
  expect_error([&] { world.add_drain({.shape = Plane{}, .rate = 0}); }, {"rate"});
  expect_error([&] { world.add_fluid(std::vector<Vec3d>{}, water); }, {"no vertices"});
  expect_error([&] { world.add_grains(std::vector<Vec3d>{{}}, {}, {.max_particles = 3}); }, {"only fluids"});
  expect_error([&] { world.remove(EmitterId{99}); }, {"no emitter has the handle 99"});
  expect_error([&] { world.pin(fluid, all()); }, {"come and go"});
}

}  // namespace souple::test_world_emitters
