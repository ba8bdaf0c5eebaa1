#include "souple/fluid/air_drag.h"
#include "souple/fluid/vorticity.h"
#include "souple/fluid/xsph.h"
#include "tests/count_allocations.h"
#include "tests/fluid/fluid_arrays.h"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

namespace souple::test_fluid_vorticity {

using test::FluidArrays;

constexpr float d = 0.02f;
constexpr auto shape = SmoothingShape::wendland;

/// A vortex around z with a core of 3 spacings (Lamb and Oseen).
struct Whirl {
  FluidArrays fluid{test::block_of(24, 24, 8, d, 0.1f), d, 1000, 5};  // nu = 0.005 m^2/s
  static Vec3f flow(const Vec3f& x) {
    const float dx = x.x - 12 * d, dy = x.y - 12 * d, r2 = dx * dx + dy * dy, core = 9 * d * d;
    const float turn = 20 * core * (1 - std::exp(-r2 / core)) / std::max(r2, 1e-8f);
    return {-dy * turn, dx * turn, 0};
  }
  Whirl() { fluid.set_velocities(flow); }
  /// Mean angular velocity of particles 2 to 4 spacings from the axis [1/s].
  double turn() const {
    double sum = 0;
    int count = 0;
    for (std::size_t k = 0; k < fluid.size(); ++k) {
      const double dx = double{fluid.x[k].x - 12 * d}, dy = double{fluid.x[k].y - 12 * d};
      const double r2 = (dx * dx + dy * dy) / double{d * d};
      if (r2 < 4 || r2 > 16) continue;
      sum += (dx * double{fluid.v[k].y} - dy * double{fluid.v[k].x}) / (dx * dx + dy * dy);
      ++count;
    }
    return sum / count;
  }
  /// Angular velocity after 0.1 s of viscosity and confinement, over its initial value.
  double left(float epsilon) {
    const double first = turn();
    VorticityConfinement confinement;
    for (int s = 0; s < 50; ++s) {
      Xsph(shape).apply(fluid.view(), {}, 2e-3f, *fluid.threads);
      if (epsilon > 0) confinement.apply(fluid.view(), epsilon, 2e-3f, *fluid.threads);
    }
    return turn() / first;
  }
};

TEST(Vorticity, IsThatOfTheFlow) {
  FluidArrays fluid(test::block_of(12, 12, 12, d), d, 1000, 0);
  fluid.set_velocities([](const Vec3f& x) { return cross(Vec3f(1, 2, 3), x); });  // omega = 2 (1, 2, 3)
  VorticityConfinement confinement;
  confinement.apply(fluid.view(), 0, 1, *fluid.threads);
  for (std::size_t k = 0; k < fluid.size(); ++k) {
    const Vec3f& x = fluid.x[k].xyz();
    if (std::max({std::abs(x.x - 6 * d), std::abs(x.y - 6 * d), std::abs(x.z - 6 * d)}) > 3 * d) continue;
    // Kernel gradients are 1.04 times the exact ones on a lattice.
    EXPECT_LT(length(confinement.vorticity()[k] - Vec3f(2, 4, 6) * 1.04f), 0.01f);
  }
}

TEST(Vorticity, AWhirlLastsLongerWithConfinement) {
  const double without = Whirl().left(0), some = Whirl().left(0.1f), more = Whirl().left(0.2f);
  EXPECT_LT(without, 0.8);
  EXPECT_GT(some, without + 0.05);
  EXPECT_GT(more, some + 0.05);
  EXPECT_LT(more, 1.2);
}

// Equations 15 and 16 of the paper, for each particle, also at a surface and in disorder.
TEST(Vorticity, IsAsInThePaper) {
  FluidArrays fluid(test::block_of(6, 6, 6, d, 0.2f), d, 1000, 0);
  fluid.set_velocities([](const Vec3f& x) { return Whirl::flow(x * 3.0f); });
  const std::vector<Vec4f> before = fluid.v;
  const double V = double{fluid.smoothing.volume()}, size = 2 * double{d};
  const std::size_t n = fluid.size();
  const auto slope = [&](std::size_t i, std::size_t j) {
    const Vec3d apart(fluid.x[i].xyz() - fluid.x[j].xyz());
    const double t = std::max(1 - length(apart) / size, 0.0);
    return apart * (double{fluid.smoothing.factors().slope_factor} * t * t * t);
  };
  std::vector<Vec3d> omega(n);
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = 0; j < n; ++j)
      omega[i] += cross(slope(i, j), Vec3d(before[j].xyz() - before[i].xyz())) * V;
  VorticityConfinement().apply(fluid.view(), 1, 1, *fluid.threads);
  for (std::size_t i = 0; i < n; ++i) {
    Vec3d eta{};
    for (std::size_t j = 0; j < n; ++j) eta += slope(i, j) * (V * (length(omega[j]) - length(omega[i])));
    const Vec3d wanted = cross(eta, omega[i]) * (1 / (length(eta) + 0.01 * length(omega[i]) / double{d}));
    EXPECT_LT(length(Vec3d(fluid.v[i].xyz() - before[i].xyz()) - wanted), 1e-3 * length(omega[i]));
  }
}

TEST(Vorticity, LeavesAloneWhatMovesAsAWhole) {
  FluidArrays fluid(test::block_of(8, 8, 8, d, 0.1f), d, 1000, 0);
  fluid.set_velocities([](const Vec3f&) { return Vec3f(1, -2, 3); });
  VorticityConfinement().apply(fluid.view(), 1, 1, *fluid.threads);
  for (std::size_t k = 0; k < fluid.size(); ++k) EXPECT_EQ(fluid.v[k].xyz(), Vec3f(1, -2, 3));
}

TEST(Vorticity, AllocatesNothingWhenWarm) {
  Whirl whirl;
  VorticityConfinement confinement;
  confinement.apply(whirl.fluid.view(), 1, 1e-3f, *whirl.fluid.threads);
  const long before = test::allocations();
  confinement.apply(whirl.fluid.view(), 1, 1e-3f, *whirl.fluid.threads);
  EXPECT_EQ(test::allocations(), before);
}

// A drop of 2 mm reaches the terminal speed sqrt(2 m g / (rho C d^2)) and drifts with the wind.
TEST(AirDrag, ADropFallsAtItsTerminalSpeed) {
  constexpr float size = 0.002f, g = 9.81f, h = 1.0f / 240;
  FluidArrays drop({{0, 0, 0, 0}}, size, 1000, 0);
  const float covered = drop.smoothing.volume() * drop.smoothing.center();
  for (int s = 0; s < 2400; ++s) {
    drop.v[0].y -= g * h;
    apply_air_drag(drop.view(), {&covered, 1}, {.wind = {3, 0, 0}}, h, *drop.threads);
  }
  const float mass = 1000 * size * size * size;
  const float terminal = std::sqrt(2 * mass * g / (1.2f * 0.47f * size * size));
  EXPECT_NEAR(drop.v[0].y, -terminal, 0.01f * terminal);
  EXPECT_NEAR(drop.v[0].x, 3, 0.05f);
}

// Wind moves surface particles, at most at its own speed, and no particles inside.
TEST(AirDrag, OnlyTheSurfaceFeelsTheWind) {
  FluidArrays fluid(test::block_of(8, 8, 8, d), d, 1000, 0);
  std::vector<float> covered(fluid.size(), 1.0f);
  for (std::size_t k = 0; k < fluid.size(); ++k)
    if (fluid.x[k].y > 7 * d) covered[k] = 0.88f;
  apply_air_drag(fluid.view(), covered, {.wind = {0, 0, 50}}, 1e3f, *fluid.threads);
  for (std::size_t k = 0; k < fluid.size(); ++k) {
    if (fluid.x[k].y < 7 * d)
      EXPECT_EQ(fluid.v[k].z, 0);
    else
      EXPECT_NEAR(fluid.v[k].z, 49, 1.0f);
  }
}

}  // namespace souple::test_fluid_vorticity
