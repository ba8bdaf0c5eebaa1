#include "tests/physics/collision_cases.h"
#include "tests/physics/motion.h"
#include "tests/physics/validation.h"

#include <cmath>

namespace souple {
namespace {

// A ball of sand falls on the floor: returns the slope of the heap.
double slope_of_pile(float mu) {
  constexpr double radius = 0.01;
  World world({.iterations = 2});
  world.add_collider(Plane{}, {.friction = 1});
  std::vector<Vec3d> centers;
  std::uint32_t state = 1;
  const auto noise = [&] {
    state = state * 1664525u + 1013904223u;
    return 0.3 * radius * (double(state >> 8) / (1 << 24) - 0.5);
  };
  // On its corner, because towers of grains would stay upright.
  const Quatd tilt = Quatd::from_euler_xyz({pi / 4, 0, 0.6155});
  for (int x = -7; x <= 7; ++x)
    for (int y = -7; y <= 7; ++y)
      for (int z = -7; z <= 7; ++z)
        if (x * x + y * y + z * z <= 30)
          centers.push_back(rotate(tilt, Vec3d{2.35 * radius * x + noise(), 2.35 * radius * y + noise(),
                                               2.35 * radius * z + noise()}));
  const ObjectId grains = world.add_grains(centers, {.radius = float(radius), .friction = mu},
                                           {.transform = {.translation = {0, 0.18, 0}}});
  EXPECT_TRUE(run(world, 240, 1.0 / 60));
  EXPECT_LT(world.kinetic_energy(grains) / world.total_mass(grains), 5e-4) << "friction " << mu;
  return test::slope_of_heap(world, grains, radius);
}

// Test of the measure: points throughout a cone.
TEST(SandPile, SlopeIsThatOfACone) {
  std::vector<Vec3d> cone;
  for (int x = -40; x <= 40; ++x)
    for (int y = 0; y <= 40; ++y)
      for (int z = -40; z <= 40; ++z)
        if (y + 0.5 <= 0.5 * (40 - std::hypot(x, z))) cone.push_back({0.01 * x, 0.01 * (y + 0.5), 0.01 * z});
  World world;
  const ObjectId grains = world.add_grains(cone, {.radius = 0.001f});
  EXPECT_NEAR(test::slope_of_heap(world, grains, 0), 0.5, 0.02);
}

TEST(SandPile, AngleOfReposeGrowsWithFriction) {
  const std::string name = "angle of repose";
  Curves curves(name, "friction coefficient", "angle of repose [degrees]");
  double before = 0;
  for (const float mu : {0.1f, 0.2f, 0.4f, 0.6f, 1.0f}) {
    const double slope = slope_of_pile(mu), angle = std::atan(slope) * 180 / pi;
    curves.add("heap of 700 grains", double(mu), angle);
    curves.add("angle at which one grain slides", double(mu), std::atan(double(mu)) * 180 / pi);
    state(name, "friction " + detail::number(double(mu), "%.1f") + " [degrees]", angle);
    EXPECT_GT(angle, before + 0.5) << mu;
    before = angle;
  }
}

}  // namespace
}  // namespace souple
