#include "souple/souple.h"
#include "souple/world/memory.h"

#include <algorithm>
#include <cstddef>

#include <gtest/gtest.h>

namespace souple::test_physics_fluid_fountain {

constexpr double d = 0.04;  // m
constexpr std::uint32_t most = 2000;

struct Flow {
  std::size_t emitted = 0, drained = 0, held_back = 0, max_alive = 0;
  double fastest = 0, mean_error = 0;
};

// A jet rises from the middle of a table, falls beside itself, runs over the table's edges and is drained.
Flow play(World& world, ObjectId fluid, int frames) {
  Flow run;
  for (int frame = 0; frame < frames; ++frame) {
    const StepReport& report = world.step(1.0 / 60);
    EXPECT_TRUE(report.ok()) << frame << ": " << report.message;
    run.emitted += report.fluid.emitted;
    run.drained += report.fluid.drained;
    run.held_back += report.fluid.held_back;
    run.fastest = std::max(run.fastest, report.fluid.fastest);
    run.mean_error += report.fluid.mean_density_error / frames;
    run.max_alive = std::max(run.max_alive, world.positions(fluid).size());
  }
  return run;
}

std::size_t bytes(World& world) {
  std::size_t sum = 0;
  const MemoryReport report = world.memory();
  for (const auto& part : report.simulation) sum += part.bytes;
  for (const auto& part : report.objects) sum += part.bytes;
  return sum;
}

TEST(FluidFountain, RunsForAMinuteWithoutGrowingSlow) {
  World world({.substeps = 8});
  const ObjectId fluid =
      world.add_fluid(std::vector<Vec3d>{}, {.spacing = float(d)}, {.max_particles = most});
  world.add_emitter(fluid,
                    {.position = {0, 0.12f, 0}, .direction = {0.12f, 1, 0}, .radius = 0.041f, .speed = 2.5f});
  world.add_collider(Box{{0, -0.05f, 0}, {0.4f, 0.05f, 0.4f}});
  world.add_drain({.shape = Plane{{0, 1, 0}, -1}});
  const Flow first = play(world, fluid, 600);
  const std::size_t held = bytes(world);
  const Flow rest = play(world, fluid, 3000);
  EXPECT_EQ(first.emitted + rest.emitted - first.drained - rest.drained, world.positions(fluid).size());
  EXPECT_LE(std::max(first.max_alive, rest.max_alive), most);
  EXPECT_GT(rest.max_alive, 250u);
  EXPECT_NEAR(double(rest.drained), double(rest.emitted), 0.02 * double(rest.emitted));  // steady state
  EXPECT_LE(double(rest.held_back), 0.02 * double(rest.emitted));
  EXPECT_LT(rest.fastest, 8);  // 2.5 m/s up, then a fall of 1.3 m: 5.7 m/s
  EXPECT_LT(rest.mean_error, 0.01);
  EXPECT_LE(double(bytes(world)), 1.1 * double(held));
}

// A horizontal jet falls like a stone from the end of its inflow zone (two spacings) on.
TEST(FluidFountain, AJetIsAParabola) {
  World world({.substeps = 8});
  const ObjectId fluid =
      world.add_fluid(std::vector<Vec3d>{}, {.spacing = float(d)}, {.max_particles = most});
  world.add_emitter(fluid, {.position = {0, 0, 0}, .direction = {1, 0, 0}, .radius = 0.081f, .speed = 2});
  play(world, fluid, 24);
  const double t = 24 / 60.0, s = t - 2 * d / 2;
  Vec3d front;  // of the first layer
  for (std::size_t i = 0; i < 13; ++i) front += Vec3d(world.positions(fluid)[i]) / 13.0;
  EXPECT_NEAR(front.x, 2 * t, 0.02);
  EXPECT_NEAR(front.y, -9.81 * s * s / 2, 0.03);  // XSPH slows it slightly
  EXPECT_NEAR(front.z, 0, 0.005);
}

}  // namespace souple::test_physics_fluid_fountain
