#include "souple/simd/instruction_set.h"
#include "souple/surface/kernels/find_kernels.h"
#include "tests/collision/random.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

namespace souple::test_surface_kernels {

using kernels::ParticleKernel;
using kernels::SurfaceKernels;

float number(test::Random& random, double lo, double hi) {
  return static_cast<float>(random.point(lo, hi).x);
}

ParticleKernel some_kernel(test::Random& random) {
  ParticleKernel kernel{};
  for (float& c : kernel.center) c = number(random, -1, 1);
  for (float& s : kernel.shift) s = number(random, -0.1, 0.1);
  kernel.weight = number(random, 0.2, 1);
  kernel.xx = number(random, 0.5, 1), kernel.yy = number(random, 0.5, 1), kernel.zz = number(random, 0.5, 1);
  kernel.xy = number(random, -0.2, 0.2), kernel.xz = number(random, -0.2, 0.2),
  kernel.yz = number(random, -0.2, 0.2);
  kernel.crowd = number(random, 0, 1);
  kernel.extent_z = 4;
  return kernel;
}

/// Reference in double, by the formula.
double value_at(const ParticleKernel& k, const Vec3d& x) {
  const Vec3d s{x.x - double{k.center[0]}, x.y - double{k.center[1]}, x.z - double{k.center[2]}};
  const Vec3d u{double{k.xx} * s.x + double{k.xy} * s.y + double{k.xz} * s.z,
                double{k.xy} * s.x + double{k.yy} * s.y + double{k.yz} * s.z,
                double{k.xz} * s.x + double{k.yz} * s.y + double{k.zz} * s.z};
  const double t = std::max(0.0, 1 - dot(u, u));
  return double{k.weight} * t * t * t;
}

struct Points {
  std::array<float, 32> at[3], value, gradient[3], shift[3], crowd;
  kernels::FieldPoints pointers() {
    return {{at[0].data(), at[1].data(), at[2].data()},
            value.data(),
            {gradient[0].data(), gradient[1].data(), gradient[2].data()},
            {shift[0].data(), shift[1].data(), shift[2].data()},
            crowd.data()};
  }
};

class SurfaceKernelsTest : public testing::Test {
 protected:
  SurfaceKernelsTest() {
    test::Random random(5);
    for (std::uint32_t i = 0; i < 40; ++i) {
      kernels_.push_back(some_kernel(random));
      list_.push_back(i);
    }
    for (auto& component : points_.at)
      for (float& x : component) x = number(random, -1, 1);
  }
  std::vector<ParticleKernel> kernels_;
  std::vector<std::uint32_t> list_;
  Points points_{};
};

TEST_F(SurfaceKernelsTest, GiveTheFieldAndItsGradient) {
  const SurfaceKernels& functions = kernels::find_surface_kernels(instruction_set());
  functions.points(kernels_.data(), list_.data(), list_.size(), points_.pointers(), 32);
  for (std::size_t p = 0; p < 32; ++p) {
    const Vec3d x{double{points_.at[0][p]}, double{points_.at[1][p]}, double{points_.at[2][p]}};
    const auto field = [&](const Vec3d& at) {
      double sum = 0;
      for (const ParticleKernel& k : kernels_) sum += value_at(k, at);
      return sum;
    };
    EXPECT_NEAR(double{points_.value[p]}, field(x), 1e-5 * field(x));
    for (int a = 0; a < 3; ++a) {
      Vec3d step;
      step[a] = 1e-5;
      EXPECT_NEAR(double{points_.gradient[a][p]}, (field(x + step) - field(x - step)) / 2e-5, 1e-4);
    }
  }
}

TEST_F(SurfaceKernelsTest, GiveTheFieldAtTheNodesOfABrick) {
  const float origin[3] = {-0.4f, -0.3f, -0.5f};
  std::array<float, kernels::brick_nodes> values{};
  kernels::find_surface_kernels(instruction_set())
      .brick(kernels_.data(), list_.data(), list_.size(), origin, 0.3f, values.data());
  for (int n = 0; n < kernels::brick_nodes; ++n) {
    const int row = n / 4, layer = n / 16;
    const Vec3d x{double{origin[0]} + 0.3 * (n % 4), double{origin[1]} + 0.3 * (row % 4),
                  double{origin[2]} + 0.3 * layer};
    double sum = 0;
    for (const ParticleKernel& k : kernels_) sum += value_at(k, x);
    EXPECT_NEAR(double{values[static_cast<std::size_t>(n)]}, sum, 1e-4);
  }
}

TEST(SurfaceMoments, AreThoseOfTheNeighbors) {
  test::Random random(6);
  std::vector<Vec4f> records(20);
  std::vector<std::uint32_t> list(32, 4 * 20);
  for (std::uint32_t i = 0; i < 20; ++i) {
    records[i].set_xyz(Vec3f(random.point(-0.8, 0.8)));
    list[i] = 4 * i;
  }
  records.push_back({1e15f, 1e15f, 1e15f, 0});
  const Vec4f at{0.1f, 0.2f, -0.1f, 0};
  double weight = 1, first = 0, xz = 0;
  for (std::size_t i = 0; i < 20; ++i) {
    const Vec3d d = Vec3d(records[i].xyz()) - Vec3d(at.xyz());
    const double w = std::max(0.0, 1 - std::pow(length(d), 3));
    weight += w, first += w * d.y, xz += w * d.x * d.z;
  }
  const kernels::Moments found =
      kernels::find_surface_kernels(instruction_set()).moments(records.data(), at, list.data(), 32, 1);
  EXPECT_NEAR(double{found.weight}, weight, 1e-5);
  EXPECT_NEAR(double{found.first[1]}, first, 1e-5);
  EXPECT_NEAR(double{found.xz}, xz, 1e-5);
}

}  // namespace souple::test_surface_kernels
