#include "souple/souple.h"
#include "validation.h"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

namespace souple::test_physics_fluid_buoyancy {

constexpr double water_density = 1000;

/// A basin of water with a box in it.
struct Basin {
  double d, side, depth, edge;
  World world;
  ObjectId water, body;

  Basin(double spacing, int across, int layers, int substeps, const FluidSettings& settings = {})
      : d(spacing),
        side(across * d),
        depth(layers * d),
        edge(0),
        world({.substeps = substeps, .fluid = settings}) {
    const double w = 0.5 * side;
    world.add_collider(Plane{});
    for (const Vec3f& n : {Vec3f{1, 0, 0}, Vec3f{-1, 0, 0}, Vec3f{0, 0, 1}, Vec3f{0, 0, -1}})
      world.add_collider(Plane{n, static_cast<float>(-w)});
  }
  /// Adds a cube of so many spacings with its lowest point at `bottom`, and the water, with a hole for the
  /// cube.
  void put(int spacings, double density, double bottom, SoftBodyModel model) {
    edge = spacings * d;
    const auto half = 0.5 * edge;
    std::vector<Vec3d> points;
    for (const Vec3d& x : fill(Vec3d{-side / 2, 0, -side / 2}, Vec3d{side / 2, depth, side / 2}, d))
      if (std::fabs(x.x) > half || std::fabs(x.z) > half || x.y < bottom || x.y > bottom + edge)
        points.push_back(x);
    water = world.add_fluid(points, {.spacing = static_cast<float>(d), .density = float(water_density)});
    SoftBodyMaterial material{.young_modulus = model == SoftBodyModel::shape_matching ? 1e10f : 1e6f,
                              .poisson_ratio = 0.3f,
                              .density = static_cast<float>(density),
                              .thickness = 0,
                              .model = model};
    body =
        world.add_soft_body(box(Vec3d{edge, edge, edge}, {8, 8, 8}), material, LatticeOptions{.cells = 3000},
                            {.transform = {.translation = {0, bottom + half, 0}}});
  }
  void run(double seconds) {
    for (int frame = 0; frame < seconds * 60; ++frame) world.step(1.0 / 60);
  }
  double lowest() const {
    double y = 1e30;
    for (const Vec3f& x : world.positions(body)) y = std::min(y, double{x.y});
    return y;
  }
  /// Water level far from the body.
  double level() const {
    // The volumes of the water and of the submerged part fill the basin up to here.
    const double water_volume = double(world.positions(water).size()) * d * d * d;
    const double y = lowest();
    return (water_volume - edge * edge * y) / (side * side - edge * edge);
  }
};

/// Released slightly above its equilibrium: submerged depth at rest over its height [-].
double sunk(double density, SoftBodyModel model, int across = 36, int layers = 26,
            const FluidSettings& settings = {}) {
  Basin basin(0.02, across, layers, 8, settings);
  basin.put(20, density, basin.depth - density / water_density * 20 * basin.d + 0.01, model);
  basin.run(2.5);
  double sum = 0;
  constexpr int frames = 30;
  for (int frame = 0; frame < frames; ++frame) {
    basin.run(1.0 / 60);
    sum += (basin.level() - basin.lowest()) / frames;
  }
  EXPECT_LT(basin.world.report().fluid.mean_density_error, 0.01);
  return sum / basin.edge;
}

TEST(FluidBuoyancy, AStiffCubeFloatsAsDeepAsItsDensitySlow) {
  EXPECT_NEAR(sunk(600, SoftBodyModel::shape_matching), 0.6, 0.03);
}

TEST(FluidBuoyancy, LightAndSoftCubesAtTheirDepthSlow) {
  EXPECT_NEAR(sunk(300, SoftBodyModel::shape_matching), 0.3, 0.03);
  EXPECT_NEAR(sunk(600, SoftBodyModel::neo_hookean), 0.6, 0.03);
}

TEST(FluidBuoyancy, ALightSoftCubeFloatsAtItsDepthSlow) {
  EXPECT_NEAR(sunk(300, SoftBodyModel::neo_hookean), 0.3, 0.03);
}

// Water behaves as a fluid in channels wide enough to avoid an ordered packing. In a basin of 36 spacings this cube
// floats 5 % of its height too high.
TEST(FluidBuoyancy, AHeavyCubeFloatsAtItsDepthSlow) {
  EXPECT_NEAR(sunk(900, SoftBodyModel::shape_matching, 46, 32), 0.9, 0.03);
}

// With more neighbors the same channel shows less order.
TEST(FluidBuoyancy, AHeavyCubeInANarrowBasinSlow) {
  EXPECT_NEAR(sunk(900, SoftBodyModel::shape_matching, 36, 26, {.kernel = SmoothingShape::wide_wendland}),
              0.9, 0.015);
}

TEST(FluidBuoyancy, AHeavySoftCubeFloatsAtItsDepthSlow) {
  EXPECT_NEAR(sunk(900, SoftBodyModel::neo_hookean, 46, 32), 0.9, 0.03);
}

// Two layers of water stay below it: its remaining weight does not displace them.
TEST(FluidBuoyancy, WhatIsHeavierThanWaterSinksSlow) {
  Basin basin(0.02, 46, 32, 8);
  basin.put(20, 1200, 0.2, SoftBodyModel::shape_matching);
  basin.run(2);
  EXPECT_LT(basin.lowest(), 3 * basin.d);
}

// It has ten seconds to rise or sink. Water that is only nearly at rest pushes it slightly.
TEST(FluidBuoyancy, WhatIsAsDenseAsWaterHoversSlow) {
  Basin basin(0.02, 40, 36, 8);
  const double bottom = (basin.depth - 20 * basin.d) / 2;
  basin.put(20, water_density, bottom, SoftBodyModel::shape_matching);
  double farthest = 0;
  for (int frame = 0; frame < 600; ++frame) {
    basin.run(1.0 / 60);
    const double low = basin.lowest(), high = low + basin.edge;
    ASSERT_GT(low, basin.d) << frame;
    ASSERT_LT(high, basin.depth - basin.d) << frame;
    farthest = std::max(farthest, std::fabs(low - bottom));
  }
  state("cube of the density of water, 20 spacings wide, left at mid-depth",
        "farthest drift in 10 s [spacings]", farthest / basin.d);
}

}  // namespace souple::test_physics_fluid_buoyancy
