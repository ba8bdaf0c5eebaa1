#include "souple/fluid/kernels/find_kernels.h"
#include "souple/fluid/kernels/shapes.h"
#include "souple/fluid/smoothing.h"
#include "souple/simd/instruction_set.h"
#include "tests/fluid/clouds.h"

#include <cmath>

#include <gtest/gtest.h>

namespace souple::test_fluid_smoothing {

constexpr SmoothingShape shapes[] = {SmoothingShape::wendland, SmoothingShape::poly6_spiky,
                                     SmoothingShape::cubic_spline, SmoothingShape::wide_wendland};

constexpr float d = 0.02f;  // m

/// V sum_j W, and V d sum_j grad W, of a particle of the lattice at rest. The sums are over the neighbors with has(i),
/// i their lattice coordinate along x.
template <class Has>
std::pair<float, Vec3f> sums_on_lattice(const Smoothing& smoothing, SmoothingShape shape, const Has& has) {
  std::vector<Vec4f> records;
  std::vector<std::uint32_t> list;
  for (int i = -3; i <= 3; ++i)
    for (int j = -3; j <= 3; ++j)
      for (int k = -3; k <= 3; ++k) {
        if ((i == 0 && j == 0 && k == 0) || !has(i)) continue;
        list.push_back(static_cast<std::uint32_t>(4 * records.size()));
        records.push_back({d * float(i), d * float(j), d * float(k), 1});
      }
  while (list.size() % 16 != 0) list.push_back(static_cast<std::uint32_t>(4 * records.size()));
  records.push_back({1e15f, 1e15f, 1e15f, 0});
  const kernels::DensitySums sums =
      kernels::find_density_kernels(instruction_set(), shape)
          .sums(records.data(), {}, list.data(), list.size(), smoothing.factors());
  return {smoothing.volume() * (sums.density + smoothing.center()), sums.gradient * (smoothing.volume() * d)};
}

double density_at_rest(SmoothingShape shape) {
  return shape == SmoothingShape::poly6_spiky ? 1.01 : 1;
}

/// Tolerance of a wall's push on a lattice: mirror factors a above 2 fit columns at rest instead.
double pushed_by_wall(SmoothingShape shape) {
  if (shape == SmoothingShape::wide_wendland) return 0.25;
  return shape == SmoothingShape::wendland ? 5e-3 : 0.15;
}

TEST(Smoothing, ALatticeAtRestHasDensityOne) {
  for (const SmoothingShape shape : shapes) {
    const auto [density, gradient] = sums_on_lattice(Smoothing(d, shape), shape, [](int) { return true; });
    EXPECT_NEAR(density, density_at_rest(shape), 1e-5);
    EXPECT_NEAR(length(gradient), 0, 1e-5);
  }
}

// The fluid behind a wall replaces the missing half of the lattice.
TEST(Smoothing, AWallStandsForTheOtherHalf) {
  for (const SmoothingShape shape : shapes) {
    const Smoothing smoothing(d, shape);
    const auto [density, gradient] = sums_on_lattice(smoothing, shape, [](int i) { return i >= 0; });
    const Smoothing::Wall wall = smoothing.wall(d / 2);
    EXPECT_NEAR(density + wall.value, density_at_rest(shape), 2e-3);
    // Equal pressures do not push: a pair of particles has two multipliers, a wall only one.
    EXPECT_NEAR(2 * gradient.x + wall.slope * d, 0, pushed_by_wall(shape));
  }
}

// The contribution grows toward the wall and is zero beyond the support.
TEST(Smoothing, AWallPushesAwayFromIt) {
  for (const SmoothingShape shape : shapes) {
    const Smoothing smoothing(1, shape);
    for (float s = -1; s < 2; s += 0.05f) {
      const float rise = smoothing.wall(s + 0.01f).value - smoothing.wall(s - 0.01f).value;
      EXPECT_LE(rise, 0);
      EXPECT_LE(smoothing.wall(s).slope, 0);
    }
    EXPECT_EQ(smoothing.wall(2).value, 0);
    EXPECT_EQ(smoothing.wall(2).slope, 0);
  }
}

TEST(Smoothing, SlopesAreDerivatives) {
  const auto check = [](const auto& shape) {
    using S = std::decay_t<decltype(shape)>;
    const double scale = S::slope(0.3) * 0.3 / (S::value(0.301) - S::value(0.299));
    for (double q = 0.05; q < 0.95; q += 0.05)
      EXPECT_NEAR(S::slope(q) * q, scale * (S::value(q + 0.001) - S::value(q - 0.001)), 1e-4) << q;
  };
  check(kernels::Wendland{});
  check(kernels::CubicSpline{});  // poly6 and spiky are different kernels: spiky is not the slope of poly6
}

// Two particles at one position push each other nowhere, and nothing becomes infinite.
TEST(DensityKernels, AreFiniteWhereParticlesCoincide) {
  std::vector<Vec4f> records = test::random_cloud(300, 1, 1), values = test::random_cloud(300, 1, 2);
  for (std::size_t i = 0; i < values.size(); ++i)
    records[i].w = values[i].w = 0.1f + 0.01f * static_cast<float>(i);
  records[7] = records[8];
  std::vector<std::uint32_t> list;
  for (std::uint32_t i = 0; i < 300; ++i) list.push_back(4 * i);
  while (list.size() % 16 != 0) list.push_back(4 * 300);
  records.push_back({1e15f, 1e15f, 1e15f, 0});
  values.push_back({});
  const Smoothing smoothing(0.2f);
  for (const SmoothingShape shape : shapes) {
    const auto& density = kernels::find_density_kernels(instruction_set(), shape);
    const auto sums = density.sums(records.data(), records[7], list.data(), list.size(), smoothing.factors());
    EXPECT_TRUE(std::isfinite(sums.density) && is_finite(sums.gradient));
    const auto& velocity = kernels::find_velocity_kernels(instruction_set(), shape);
    const auto sum = [&](const auto& function, const auto&... more) {
      return function(records.data(), values.data(), records[7], values[7], list.data(), list.size(),
                      smoothing.factors(), more...);
    };
    EXPECT_TRUE(is_finite(sum(velocity.strain)) && is_finite(sum(velocity.curl)));
    EXPECT_TRUE(is_finite(sum(velocity.cohesion, kernels::CohesionFactors{0.3f, 0.2f})));
  }
}

}  // namespace souple::test_fluid_smoothing
