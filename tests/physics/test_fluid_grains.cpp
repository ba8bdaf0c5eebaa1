#include "souple/souple.h"

#include <array>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

namespace souple::test_physics_fluid_grains {

constexpr double d = 0.02, depth = 0.3;  // m

/// A basin of water.
struct Basin {
  World world{{.substeps = 8}};
  ObjectId water;

  explicit Basin(const Vec3d& size = {0.3, depth, 0.16}) {
    world.add_collider(Plane{});
    for (const Vec3f& n : {Vec3f{1, 0, 0}, Vec3f{-1, 0, 0}})
      world.add_collider(Plane{n, static_cast<float>(-size.x / 2)});
    for (const Vec3f& n : {Vec3f{0, 0, 1}, Vec3f{0, 0, -1}})
      world.add_collider(Plane{n, static_cast<float>(-size.z / 2)});
    water =
        world.add_fluid(fill(Vec3d{-size.x / 2, 0, -size.z / 2}, Vec3d{size.x / 2, size.y, size.z / 2}, d),
                        {.spacing = float(d), .density = 1000});
  }
  ObjectId add_grain(double radius, double density, const Vec3d& at) {
    return world.add_grains(std::array{at}, {.radius = float(radius), .density = float(density)});
  }
  /// A rope of a quarter of a meter, along x.
  ObjectId add_rope(double density, double y, double z) {
    return world.add_rope(std::array{Vec3d{-0.12, y, z}, Vec3d{0.12, y, z}}, 12,
                          {.radius = 0.006f, .density = float(density)});
  }
  void run(double seconds) {
    for (int frame = 0; frame < seconds * 60; ++frame) ASSERT_TRUE(world.step(1.0 / 60).ok());
  }
  double height(ObjectId object) const { return world.center_of_mass(object).y; }
};

// Grains far smaller than a particle's spacing, and about as large.
TEST(FluidGrains, HeavyOnesSinkLightOnesFloatEvenOnesStay) {
  struct Trial {
    double radius;
    ObjectId heavy, even, light;
  };
  Basin basin;
  std::vector<Trial> trials;
  for (const double radius : {0.003, 0.015}) {
    const double z = radius > 0.01 ? 0.03 : -0.03;
    trials.push_back({radius, basin.add_grain(radius, 2500, {-0.1, 0.2, z}),
                      basin.add_grain(radius, 1000, {0, 0.15, z}),
                      basin.add_grain(radius, 500, {0.1, 0.1, z})});
  }
  basin.run(2);
  for (const Trial& trial : trials) {
    EXPECT_NEAR(basin.height(trial.heavy), trial.radius, 0.1 * d);
    EXPECT_NEAR(basin.height(trial.even), 0.15, d);
    EXPECT_NEAR(basin.height(trial.light), depth, d / 2);
  }
}

// Five spacings in diameter: half of it should be submerged.
TEST(FluidGrains, ALargeBallFloatsAboutAsDeepAsItsDensity) {
  Basin basin({0.3, 0.2, 0.3});
  constexpr double radius = 0.05;
  const ObjectId ball = basin.add_grain(radius, 500, {0, 0.19, 0});
  basin.run(2);
  // It still bobs by a centimeter, and rolls along the walls that it touches: the mean counts.
  constexpr int frames = 90;
  double mean = 0;
  for (int frame = 0; frame < frames; ++frame) {
    basin.run(1.0 / 60);
    mean += basin.height(ball) / frames;
  }
  EXPECT_NEAR(mean, 0.2, 0.4 * radius);
}

TEST(FluidGrains, RopesSinkAndFloat) {
  Basin basin;
  const ObjectId light = basin.add_rope(500, 0.1, -0.04), heavy = basin.add_rope(2000, 0.2, 0.04);
  basin.run(2);
  EXPECT_NEAR(basin.height(light), depth, d / 2);
  EXPECT_LT(basin.height(heavy), 0.006 + d / 2);
}

// The weight of a grain on a spring in water is reduced by that of the displaced water.
TEST(FluidGrains, AGrainInWaterWeighsLess) {
  Basin basin({0.2, 0.2, 0.16});
  constexpr double radius = 0.008, density = 3000, compliance = 0.01;
  const ObjectId grain = basin.add_grain(radius, density, {0, 0.1, 0});
  basin.world.attach(grain, vertices({0}), {}, float(compliance));
  basin.run(1);
  double pull = 0;
  constexpr int frames = 30;
  for (int frame = 0; frame < frames; ++frame) {
    basin.run(1.0 / 60);
    pull += (0.1 - basin.height(grain)) / compliance / frames;
  }
  const double weight = 9.81 * basin.world.total_mass(grain);
  EXPECT_NEAR(pull / weight, 1 - 1000 / density, 0.02);
}

// rho / 2 C pi r^2 v^2 = (rho_b - rho) V g, half a second after its release.
TEST(FluidGrains, AGrainSinksAsFastAsItsDragAllows) {
  Basin basin;
  constexpr double radius = 0.005, density = 2500;
  const ObjectId grain = basin.add_grain(radius, density, {0, 0.29, 0});
  basin.run(0.25);
  const double begin = basin.height(grain);
  basin.run(0.1);
  const double speed = (begin - basin.height(grain)) / 0.1;
  const double terminal = std::sqrt((density / 1000 - 1) * 9.81 * radius * 8 / 3 / 0.47);
  EXPECT_NEAR(speed / terminal, 1, 0.15);
}

// A cube of water with grains and a rope in it, without gravity: they fly through the water and accelerate
// it.
TEST(FluidGrains, MomentumStays) {
  World world({.substeps = 8, .gravity = {}});
  const ObjectId water = world.add_fluid(fill(Vec3d{-0.1, -0.1, -0.1}, Vec3d{0.1, 0.1, 0.1}, d),
                                         {.spacing = float(d), .viscosity = 0.5f});
  const ObjectId grains = world.add_grains(fill(Vec3d{-0.05, -0.05, -0.05}, Vec3d{0.05, 0.05, 0.05}, 0.025),
                                           {.radius = 0.008f, .density = 2000}, {.velocity = {1, 0, 0}});
  const ObjectId rope = world.add_rope(std::array{Vec3d{-0.08, 0.075, 0}, Vec3d{0.08, 0.075, 0}}, 8,
                                       {.radius = 0.005f, .density = 300}, {.velocity = {0, 0, -2}});
  const auto momentum = [&] { return world.momentum(water) + world.momentum(grains) + world.momentum(rope); };
  const Vec3d before = momentum();
  for (int frame = 0; frame < 60; ++frame) ASSERT_TRUE(world.step(1.0 / 60).ok());
  EXPECT_LT(length(momentum() - before), 1e-5 * length(before));
  EXPECT_GT(world.momentum(water).x, 0.1 * before.x);
}

TEST(FluidGrains, RainOfGrainsIntoWaterStaysCalm) {
  for (const float density : {100.0f, 2000.0f}) {
    Basin basin({0.2, 0.16, 0.16});
    const auto points = fill(Vec3d{-0.08, 0.25, -0.06}, Vec3d{0.08, 0.45, 0.06}, 0.02);
    const ObjectId grains =
        basin.world.add_grains(points, {.radius = 0.008f, .density = density}, {.velocity = {0, -3, 0}});
    for (int frame = 0; frame < 120; ++frame) {
      ASSERT_TRUE(basin.world.step(1.0 / 60).ok());
      for (const Vec3f& v : basin.world.velocities(basin.water)) ASSERT_LT(length(v), 6) << frame;
      for (const Vec3f& v : basin.world.velocities(grains)) ASSERT_LT(length(v), 6) << frame;
    }
    EXPECT_EQ(basin.height(grains) > 0.14, density < 1000) << basin.height(grains);
    EXPECT_EQ(basin.height(grains) < 0.1, density > 1000);
  }
}

}  // namespace souple::test_physics_fluid_grains
