#include "souple/souple.h"
#include "validation.h"

#include <cmath>
#include <random>
#include <vector>

#include <gtest/gtest.h>

namespace souple::test_physics_fluid_layers {

constexpr double d = 0.02;  // m
constexpr int across = 12, layers = 20;

/// Ten layers of a lighter fluid under ten of water, in disorder, with a wavy interface. Returns the height
/// of its center after some seconds over the total height: a quarter at the start, three quarters at
/// equilibrium.
double risen(float density, SmoothingShape kernel, double seconds) {
  World world({.substeps = 8, .fluid = {.kernel = kernel}});
  constexpr double w = 0.5 * across * d, height = layers * d;
  std::mt19937 generator(3);
  std::uniform_real_distribution<double> shift(-0.25 * d, 0.25 * d);
  std::vector<Vec3d> light, heavy;
  for (const Vec3d& x : fill(Vec3d{-w, 0, -w}, Vec3d{w, height, w}, d)) {
    const double border = height / 2 + 2 * d * std::cos(pi * x.x / w);
    const double dx = shift(generator), dy = shift(generator), dz = shift(generator);
    (x.y < border ? light : heavy).push_back(x + Vec3d{dx, dy, dz});
  }
  const ObjectId lighter = world.add_fluid(light, {.spacing = float(d), .density = density});
  world.add_fluid(heavy, {.spacing = float(d), .density = 1000});
  world.add_collider(Plane{});
  for (const Vec3f& n : {Vec3f{1, 0, 0}, Vec3f{-1, 0, 0}, Vec3f{0, 0, 1}, Vec3f{0, 0, -1}})
    world.add_collider(Plane{n, static_cast<float>(-w)});
  for (int frame = 0; frame < seconds * 60; ++frame) world.step(1.0 / 60);
  return world.center_of_mass(lighter).y / height;
}

// The lighter fluid rises. Particles under pressure resist rearrangement, less so with more neighbors.
TEST(FluidLayers, ALighterFluidRisesInTheWideKernel) {
  const double wide = risen(850, SmoothingShape::wide_wendland, 3);
  EXPECT_GT(wide, 0.34);
  const double usual = risen(850, SmoothingShape::wendland, 3);
  EXPECT_GT(usual, 0.25);
  EXPECT_GT(wide, usual + 0.05);
  state("ten layers of 850 kg/m^3 under ten of 1000, after 3 s",
        "center of the lighter fluid, in heights, wide_wendland", wide);
  state("ten layers of 850 kg/m^3 under ten of 1000, after 3 s",
        "center of the lighter fluid, in heights, wendland", usual);
}

}  // namespace souple::test_physics_fluid_layers
