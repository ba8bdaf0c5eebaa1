#include "souple/souple.h"

#include <algorithm>
#include <cmath>
#include <string>

#include <gtest/gtest.h>

namespace souple {
namespace {

constexpr double water_density = 1000;

/// A basin of water with a box in it.
struct Basin {
  double d, side, depth, edge;
  World world;
  ObjectId water, body;

  Basin(double spacing, int across, int layers, int substeps)
      : d(spacing), side(across * d), depth(layers * d), edge(0), world({.substeps = substeps}) {
    const double w = 0.5 * side;
    world.add_collider(Plane{});
    for (const Vec3f& n : {Vec3f{1, 0, 0}, Vec3f{-1, 0, 0}, Vec3f{0, 0, 1}, Vec3f{0, 0, -1}})
      world.add_collider(Plane{n, static_cast<float>(-w)});
  }
  /// A cube of so many spacings whose lowest point is at `bottom`; the water has a hole for what is in it.
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
  /// Of the water far from the body.
  double level() const {
    // The volume of water and of what hangs into it fill the basin up to here.
    const double water_volume = double(world.positions(water).size()) * d * d * d;
    const double y = lowest();
    return (water_volume - edge * edge * y) / (side * side - edge * edge);
  }
};

void floats(double density, SoftBodyModel model) {
  Basin basin(0.02, 36, 26, 8);
  // Let down where it belongs, a little too high.
  const double immersed = density / water_density * 20 * basin.d;
  basin.put(20, density, basin.depth - immersed + 0.01, model);
  basin.run(4);
  double sunk = 0;
  constexpr int frames = 30;
  for (int frame = 0; frame < frames; ++frame) {
    basin.run(1.0 / 60);
    sunk += (basin.level() - basin.lowest()) / frames;
  }
  std::printf(
      "density %g: sunk %.4f of %.4f, error %.2f %% of the height; level %.3f bottom %.3f mean err %.4f\n",
      density, sunk, immersed, 100 * (sunk - immersed) / basin.edge, basin.level(), basin.lowest(),
      basin.world.report().fluid.mean_density_error);
  EXPECT_NEAR(sunk, immersed, 0.03 * basin.edge);
}

TEST(FluidBuoyancy, Trace) {
  Basin basin(0.02, 48, 34, 9);
  basin.put(20, 900, basin.depth - 0.36 + 0.01, SoftBodyModel::shape_matching);
  for (int i = 0; i < 16; ++i) {
    basin.run(0.25);
    std::vector<float> tops;
    for (const Vec3f& x : basin.world.positions(basin.water))
      if (std::fabs(x.x) > 0.25f && std::fabs(x.z) > 0.25f) tops.push_back(x.y);
    std::sort(tops.begin(), tops.end());
    const auto& r = basin.world.report();
    std::printf("%.2f sunk %.4f level %.4f top %.4f vy %.5f p %.0f ke %.4f\n", basin.world.time(),
                basin.level() - basin.lowest(), basin.level(), tops[tops.size() - 72] + 0.01,
                basin.world.momentum(basin.body).y / basin.world.total_mass(basin.body),
                r.fluid.largest_pressure, basin.world.kinetic_energy(basin.water));
  }
}
TEST(FluidBuoyancy, Stiff03) {
  floats(300, SoftBodyModel::shape_matching);
}
TEST(FluidBuoyancy, Stiff06) {
  floats(600, SoftBodyModel::shape_matching);
}
TEST(FluidBuoyancy, Soft06) {
  floats(600, SoftBodyModel::neo_hookean);
}
TEST(FluidBuoyancy, Stiff09) {
  floats(900, SoftBodyModel::shape_matching);
}

}  // namespace
}  // namespace souple
