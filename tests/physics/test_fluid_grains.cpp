#include "souple/souple.h"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

namespace souple {
namespace {

constexpr double d = 0.02, depth = 0.3;  // m

/// A basin of water, 0.4 m wide.
struct Basin {
  World world{{.substeps = 8}};
  ObjectId water;

  Basin() {
    world.add_collider(Plane{});
    for (const Vec3f& n : {Vec3f{1, 0, 0}, Vec3f{-1, 0, 0}, Vec3f{0, 0, 1}, Vec3f{0, 0, -1}})
      world.add_collider(Plane{n, -0.2f});
    water = world.add_fluid(fill(Vec3d{-0.2, 0, -0.2}, Vec3d{0.2, depth, 0.2}, d),
                            {.spacing = float(d), .density = 1000});
  }
  void run(double seconds) {
    for (int frame = 0; frame < seconds * 60; ++frame) ASSERT_TRUE(world.step(1.0 / 60).ok());
  }
  double height(ObjectId object) const { return world.centre_of_mass(object).y; }
};

ObjectId add_grain(World& world, double density, double y, double x = 0, double radius = 0.006) {
  const std::vector<Vec3d> at{{x, y, 0}};
  return world.add_grains(at, {.radius = float(radius), .density = float(density)});
}

TEST(FluidGrains, HeavyOnesSinkLightOnesFloat) {
  for (const double radius : {0.003, 0.01, 0.018}) {
    Basin basin;
    const ObjectId heavy = add_grain(basin.world, 2500, 0.2, -0.1, radius);
    const ObjectId even = add_grain(basin.world, 1000, 0.15, 0, radius);
    const ObjectId light = add_grain(basin.world, 500, 0.1, 0.1, radius);
    basin.run(2);
    std::printf("r %g: heavy %f even %f light %f\n", radius, basin.height(heavy), basin.height(even), basin.height(light));
    EXPECT_LT(basin.height(heavy), radius + 0.005);
    EXPECT_NEAR(basin.height(light), depth, d);
    EXPECT_NEAR(basin.height(even), 0.15, 2 * d);
  }
}

}  // namespace
}  // namespace souple
