#include "souple/souple.h"
#include "validation.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

namespace souple::test_physics_fluid_column {

constexpr double g = 9.81, density = 1000;

/// A column of water between four walls, on a floor.
struct Column {
  double d, width, height;
  World world;
  ObjectId water;
  ColliderId floor;

  Column(double spacing, int across, int layers, int substeps, const FluidSettings& settings = {})
      : d(spacing), width(across * d), height(layers * d), world({.substeps = substeps, .fluid = settings}) {
    const double w = 0.5 * width;
    water = world.add_fluid(fill(Vec3d{-w, 0, -w}, Vec3d{w, height, w}, d),
                            {.spacing = static_cast<float>(d), .density = static_cast<float>(density)});
    floor = world.add_collider(Plane{});
    const auto offset = static_cast<float>(-w);
    for (const Vec3f& n : {Vec3f{1, 0, 0}, Vec3f{-1, 0, 0}, Vec3f{0, 0, 1}, Vec3f{0, 0, -1}})
      world.add_collider(Plane{n, offset});
  }
  void run(double seconds) {
    for (int frame = 0; frame < seconds * 60; ++frame) world.step(1.0 / 60);
  }
  /// Mean pressure of the particles whose center lies within d/2 of a height, over the hydrostatic pressure
  /// [-].
  double pressure_at(double y) const {
    const std::vector<float> pressures = world.pressures(water);
    double sum = 0, expected = 0;
    for (std::size_t i = 0; i < pressures.size(); ++i) {
      const double at = double{world.positions(water)[i].y};
      if (std::fabs(at - y) > d / 2) continue;
      sum += double{pressures[i]};
      expected += density * g * (height - at);
    }
    return sum / expected;
  }
  /// Height of the centers of the topmost layer, plus half a spacing [m].
  double top() const {
    std::vector<float> y;
    for (const Vec3f& x : world.positions(water)) y.push_back(x.y);
    std::sort(y.begin(), y.end());
    const auto layer = static_cast<std::size_t>(std::lround(width / d * width / d));
    return double{y[y.size() - layer / 2]} + d / 2;
  }
};

// The floor supports the weight; the pressure at the bottom is rho g H, at half the height half of it.
/// `calm`: limit of the speed after three and a half seconds [m/s].
void expect_rest(int substeps, double calm, const FluidSettings& settings) {
  Column column(0.02, 10, 50, substeps, settings);
  column.run(3);
  const double early = column.world.kinetic_energy(column.water);
  double floor = 0, bottom = 0, middle = 0, error = 0;
  constexpr int frames = 30;
  for (int frame = 0; frame < frames; ++frame) {
    column.run(1.0 / 60);
    floor += column.world.fluid_force(column.floor).y / frames;
    bottom += column.pressure_at(column.d / 2) / frames;
    middle += column.pressure_at(column.height / 2) / frames;
    error = std::max(error, column.world.report().fluid.mean_density_error);
  }
  const double weight = column.world.total_mass(column.water) * g;
  EXPECT_NEAR(-floor / weight, 1, 0.02);
  EXPECT_NEAR(bottom, 1, 0.02);
  EXPECT_NEAR(middle, 1, 0.02);
  EXPECT_NEAR(column.top() / column.height, 1, 0.02);
  EXPECT_LT(error, 0.01);
  const double late = column.world.kinetic_energy(column.water);
  EXPECT_LT(late, 1.2 * early);
  EXPECT_LT(std::sqrt(2 * late / column.world.total_mass(column.water)), calm);
  EXPECT_FALSE(column.world.report().has(Flag::coarse_substeps));
}

TEST(FluidColumn, RestsUnderItsOwnWeight) {
  expect_rest(8, 0.003, {});
}

TEST(FluidColumn, RestsWithTheWideKernelToo) {
  expect_rest(9, 0.005, {.kernel = SmoothingShape::wide_wendland});
}

struct Case {
  double spacing;  // m
  int layers, substeps;
};

class FluidColumnOf : public ::testing::TestWithParam<Case> {};

// Three spacings, three depths; substeps by the rule of docs/fluids.md.
TEST_P(FluidColumnOf, RestsUnderItsOwnWeightSlow) {
  const Case& param = GetParam();
  Column column(param.spacing, 10, param.layers, param.substeps);
  column.run(1);
  const double early = column.world.kinetic_energy(column.water);
  column.run(2.5);
  double floor = 0, bottom = 0, height = 0, error = 0, late = 0;
  constexpr int frames = 30;
  for (int frame = 0; frame < frames; ++frame) {
    column.run(1.0 / 60);
    floor -= column.world.fluid_force(column.floor).y / frames;
    bottom += column.pressure_at(column.d / 2) / frames;
    height += column.top() / column.height / frames;
    error = std::max(error, column.world.report().fluid.mean_density_error);
    late += column.world.kinetic_energy(column.water) / frames;
  }
  const double mass = column.world.total_mass(column.water);
  const std::string name = "water column at rest, spacing " + detail::number(1000 * param.spacing) + " mm";
  const std::string layers = std::to_string(param.layers) + " layers: ";
  validate_relative(name, layers + "force on the floor / weight", floor / (mass * g), 1, 0.02);
  validate_relative(name, layers + "pressure at the bottom / rho g H", bottom, 1, 0.02);
  validate_relative(name, layers + "height / H", height, 1, 0.02);
  validate_below(name, layers + "mean density error", error, 0.01);
  validate_below(name, layers + "speed after 4 s, rms [m/s]", std::sqrt(2 * late / mass), 0.005);
  EXPECT_LT(late, 0.5 * early);
}

INSTANTIATE_TEST_SUITE_P(Columns, FluidColumnOf,
                         ::testing::Values(Case{0.02, 25, 6}, Case{0.02, 50, 8}, Case{0.02, 75, 10},
                                           Case{0.01, 25, 8}, Case{0.01, 50, 12}, Case{0.01, 75, 14},
                                           Case{0.005, 25, 12}, Case{0.005, 50, 16}, Case{0.005, 75, 20}));

// A compressible fluid is denser at its bottom, independent of substeps and iterations. Its energy V C^2 / (2
// kappa) per particle gives kappa p = C (1 + C)^2; the reported pressure is C / kappa. With p linear in the
// mass above, P = rho_0 g H,
//   mean C = (c^2 / 2 + 4 c^3 / 3 + 3 c^4 / 4) / kappa P,   lower by (c^2 / 2 + c^3) / kappa P of its height
// where c is C at the bottom. It oscillates with a period of 4 H sqrt(kappa rho): means are over two periods.
TEST(FluidColumn, GivesWayAsItsCompressibilitySays) {
  constexpr double kappa = 2e-5, d = 0.02, pressure = density * g * 25 * d, x = kappa * pressure;
  double c = x;
  for (int i = 0; i < 50; ++i) c = x / ((1 + c) * (1 + c));
  const double mean = (c * c / 2 + 4 * c * c * c / 3 + 3 * c * c * c * c / 4) / x,
               lower = (c * c / 2 + c * c * c) / x;
  std::vector<double> fallen;
  for (const auto& [substeps, iterations] :
       {std::pair(6, 1), std::pair(12, 1), std::pair(8, 4), std::pair(8, 0)}) {
    Column column(d, 8, 25, substeps,
                  {.iterations = iterations, .compressibility = static_cast<float>(kappa)});
    column.run(2);
    double top = 0, error = 0, bottom = 0;
    constexpr int frames = 34;
    for (int frame = 0; frame < frames; ++frame) {
      column.run(1.0 / 60);
      top += column.top() / frames;
      error += column.world.report().fluid.mean_density_error / frames;
      bottom += column.pressure_at(d / 2) / frames;
    }
    fallen.push_back(1 - top / column.height);
    EXPECT_NEAR(error / mean, 1, 0.05) << substeps << " substeps, " << iterations;
    EXPECT_NEAR(bottom * (1 + c) * (1 + c), 1, 0.05) << substeps << " substeps, " << iterations;
    // 0.003 is its drop without compressibility; the packing's sums underestimate the compression.
    EXPECT_NEAR((fallen.back() - 0.003) / lower, 1.1, 0.1) << substeps << " substeps, " << iterations;
    EXPECT_NEAR(fallen.back() / fallen[0], 1, 0.03) << substeps << " substeps, " << iterations;
  }
}

}  // namespace souple::test_physics_fluid_column
