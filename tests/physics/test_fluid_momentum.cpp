#include "souple/souple.h"
#include "validation.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include <gtest/gtest.h>

// No gravity, no walls, no vorticity confinement, no drag: no external source of momentum.

namespace souple::test_physics_fluid_momentum {

constexpr double d = 0.02;  // m

/// sum m |v| of a fluid [kg m/s].
double sum_of_momenta(const World& world, ObjectId fluid) {
  const double mass = world.total_mass(fluid) / double(world.positions(fluid).size());
  double sum = 0;
  for (const Vec3f& v : world.velocities(fluid)) sum += mass * double{length(v)};
  return sum;
}

/// Angular momentum of a fluid about the origin [kg m^2/s].
Vec3d angular_momentum(const World& world, ObjectId fluid) {
  const auto x = world.positions(fluid), v = world.velocities(fluid);
  Vec3d sum{};
  for (std::size_t i = 0; i < x.size(); ++i) sum += cross(Vec3d(x[i]), Vec3d(v[i]));
  return sum * (world.total_mass(fluid) / double(x.size()));
}

// A sheet that the water accelerates, and the reaction on the water.
TEST(FluidMomentum, IsKeptWithClothInTheWater) {
  World world({.substeps = 8, .gravity = {}});
  const ObjectId fluid =
      world.add_fluid(fill(Vec3d{-0.2, -0.2, -0.2}, Vec3d{0.2, 0.2, 0.2}, d), {.spacing = float(d)});
  ClothMaterial material = material::cotton;
  material.air_drag = 0;
  material.air_lift = 0;
  const ObjectId cloth = world.add_cloth(grid(12, 12, 0.25f), material, {.velocity = {0, 1, 0}});
  std::vector<Vec3f> v;
  for (const Vec3f& x : world.positions(fluid)) v.push_back({2 * x.y, x.x, 0.3f});
  world.set_velocities(fluid, v);
  const auto momentum = [&] { return world.momentum(fluid) + world.momentum(cloth); };
  const Vec3d before = momentum(), of_cloth = world.momentum(cloth);
  const double sum = sum_of_momenta(world, fluid);
  for (int frame = 0; frame < 60; ++frame) ASSERT_TRUE(world.step(1.0 / 60).ok());
  // Most of its momentum has gone to the water.
  EXPECT_GT(length(world.momentum(cloth) - of_cloth), 0.3 * length(of_cloth));
  validate_below("fluid without gravity and walls",
                 "cloth in the fluid: change of linear momentum in 1 s / sum m |v|",
                 length(momentum() - before) / sum, 1e-4);
}

/// A ball of fluid in rigid rotation: changes within a second, relative to the initial values.
struct Spun {
  double linear, angular;  // relative to sum m |v| and to L
};
Spun spin(const FluidMaterial& material) {
  World world({.substeps = 8, .gravity = {}});
  std::vector<Vec3d> points;
  for (const Vec3d& x : fill(Vec3d{-0.2, -0.2, -0.2}, Vec3d{0.2, 0.2, 0.2}, d))
    if (length(x) < 0.2) points.push_back(x);
  FluidMaterial fluid_material = material;
  fluid_material.spacing = float(d);
  const ObjectId fluid = world.add_fluid(points, fluid_material);
  std::vector<Vec3f> v;
  for (const Vec3f& x : world.positions(fluid)) v.push_back(cross(Vec3f{0, 0, 2}, x));  // 2 rad/s
  world.set_velocities(fluid, v);
  const Vec3d linear = world.momentum(fluid), angular = angular_momentum(world, fluid);
  const double sum = sum_of_momenta(world, fluid);
  for (int frame = 0; frame < 60; ++frame) world.step(1.0 / 60);
  return {length(world.momentum(fluid) - linear) / sum,
          length(angular_momentum(world, fluid) - angular) / length(angular)};
}

TEST(FluidMomentum, OfASpinningBall) {
  const std::string name = "fluid without gravity and walls", of = "ball of 20 spacings at 2 rad/s, ";
  FluidMaterial bare = material::water;
  bare.xsph = 0;
  for (const auto& [label, material] : {std::pair{"water", material::water},
                                        {"water, xsph 0", bare},
                                        {"oil", material::oil},
                                        {"honey", material::honey}}) {
    const Spun spun = spin(material);
    validate_below(name, of + label + ": change of linear momentum in 1 s / sum m |v|", spun.linear, 1e-4);
    state(name, of + label + ": change of angular momentum in 1 s", spun.angular);
    EXPECT_LT(spun.angular, 0.5) << label;
  }
}

}  // namespace souple::test_physics_fluid_momentum
