#include "souple/souple.h"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

namespace souple::test_physics_fluid_friction {

constexpr double d = 0.02;  // m
// A film with strong friction at bodies: nu = 0.01 m^2/s.
constexpr FluidMaterial syrup{.spacing = 0.02f, .density = 1000, .viscosity = 10, .xsph = 0};

/// A block of fluid on a sheet of cloth, without gravity or walls.
struct Layers {
  World world{{.substeps = 8, .gravity = {}}};
  ObjectId fluid, cloth;

  explicit Layers(const FluidMaterial& material, float areal_density = 0.2f, float size = 0.6f) {
    constexpr float half_thickness = 0.0005f;
    fluid = world.add_fluid(
        fill(Vec3d{-0.2, half_thickness, -0.2}, Vec3d{0.2, 0.16 + half_thickness, 0.2}, d), material);
    cloth = world.add_cloth(grid(31, 31, size),
                            {.areal_density = areal_density, .thickness = 2 * half_thickness});
  }
  Vec3d mean_velocity(ObjectId object) const { return world.momentum(object) / world.total_mass(object); }
  Vec3d momentum() const { return world.momentum(fluid) + world.momentum(cloth); }
  void set_velocity(ObjectId object, const Vec3f& velocity) {
    world.set_velocities(object, std::vector<Vec3f>(world.positions(object).size(), velocity));
  }
};

// A sheet that is pulled through a fluid moves it and is slowed by it; together they conserve momentum.
TEST(FluidFriction, ASheetAndWhatFlowsAlongItComeToOneSpeed) {
  Layers layers(syrup);
  layers.set_velocity(layers.fluid, {1, 0, 0.5f});
  const Vec3d before = layers.momentum();
  for (int frame = 0; frame < 30; ++frame) {
    ASSERT_TRUE(layers.world.step(1.0 / 60).ok());
    ASSERT_LT(length(layers.momentum() - before), 1e-5 * length(before)) << frame;
  }
  const Vec3d fluid = layers.mean_velocity(layers.fluid), cloth = layers.mean_velocity(layers.cloth);
  EXPECT_GT(fluid.x, 0.9);
  EXPECT_NEAR(cloth.x / fluid.x, 1, 0.02);
  EXPECT_NEAR(cloth.z / fluid.z, 1, 0.02);
}

// The layer at d/2 from the sheet feels mu v / (d/2), before larger motion.
TEST(FluidFriction, ASheetFeelsTheShearOfTheLayersNextToIt) {
  Layers layers(syrup, 200);
  layers.set_velocity(layers.fluid, {1, 0, 0});
  constexpr double h = 5e-4;
  Settings settings = layers.world.settings();
  settings.substeps = 1;
  layers.world.set_settings(settings);
  layers.world.step(h);
  const double stress = 10 * 1.0 / (d / 2), area = 0.4 * 0.4;
  EXPECT_NEAR(layers.world.momentum(layers.cloth).x / (stress * area * h), 1, 0.05);
}

TEST(FluidFriction, AFluidThatSlipsLeavesASheetAlone) {
  FluidMaterial slips = syrup;
  slips.friction = 0;
  Layers layers(slips);
  layers.set_velocity(layers.fluid, {1, 0, 0});
  layers.world.step(1.0 / 60);
  EXPECT_LT(std::fabs(layers.mean_velocity(layers.cloth).x), 1e-3);
}

// Ten times the viscosity limit of an explicit step, and a sheet of a hundredth of its layer's mass.
TEST(FluidFriction, ALightSheetInStiffHoneyStaysCalm) {
  FluidMaterial stiff = syrup;
  stiff.viscosity = 1000;
  Layers layers(stiff, 0.02f, 0.4f);
  layers.set_velocity(layers.fluid, {1, 0, 0});
  for (int frame = 0; frame < 20; ++frame) {
    ASSERT_TRUE(layers.world.step(1.0 / 60).ok());
    for (const Vec3f& v : layers.world.velocities(layers.cloth)) ASSERT_LT(length(v), 1.5f) << frame;
  }
  EXPECT_NEAR(layers.mean_velocity(layers.cloth).x, 1, 0.02);
}

// A film on an obstacle that is pulled away moves with it.
TEST(FluidFriction, AnObstacleTakesTheFluidOnItAlong) {
  World world({.substeps = 8});
  world.add_obstacle(grid(2, 2, 4.0f), {.thickness = 0.002f},
                     ObstacleMotion{.pose = ColliderMotion::callback([](double t) {
                                      return Transform{.translation = {0.2 * t, 0, 0}};
                                    })});
  const ObjectId fluid = world.add_fluid(fill(Vec3d{-0.1, 0.001, -0.1}, Vec3d{0.1, 0.041, 0.1}, d), syrup);
  for (int frame = 0; frame < 60; ++frame) ASSERT_TRUE(world.step(1.0 / 60).ok());
  EXPECT_NEAR(world.momentum(fluid).x / world.total_mass(fluid), 0.2, 0.01);
}

// Adhesion: both pull at each other, without external forces.
TEST(FluidFriction, ADropClingsToASheetAndMomentumStays) {
  World world({.substeps = 8, .gravity = {}});
  std::vector<Vec3d> points;
  for (const Vec3d& x : fill(Vec3d{-0.1, 0.001, -0.1}, Vec3d{0.1, 0.1, 0.1}, d)) points.push_back(x);
  const ObjectId fluid =
      world.add_fluid(points, {.spacing = 0.02f, .density = 1000, .surface_tension = 1, .contact_angle = 40});
  const ObjectId cloth = world.add_cloth(grid(21, 21, 0.4f), {.areal_density = 1, .thickness = 0.001f});
  world.set_velocities(fluid, std::vector<Vec3f>(points.size(), Vec3f{0, 0.05f, 0}));
  const double mass = world.total_mass(fluid);
  const Vec3d before = world.momentum(fluid) + world.momentum(cloth);
  for (int frame = 0; frame < 120; ++frame) ASSERT_TRUE(world.step(1.0 / 60).ok());
  const Vec3d after = world.momentum(fluid) + world.momentum(cloth);
  EXPECT_LT(length(after - before), 1e-5 * mass);
  EXPECT_GT(world.momentum(cloth).y / world.total_mass(cloth), 0.02);
}

}  // namespace souple::test_physics_fluid_friction
