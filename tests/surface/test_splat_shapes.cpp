#include "souple/error.h"
#include "souple/simd/instruction_set.h"
#include "souple/surface/kernels/find_kernels.h"
#include "souple/surface/splat_shapes.h"
#include "tests/collision/random.h"
#include "tests/count_allocations.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include <gtest/gtest.h>

namespace souple::test_surface_splat_shapes {

constexpr float d = 0.02f;  // m

/// Layers at y = 0, -d, -2 d and so on; every particle is displaced by up to `jitter` spacings.
std::vector<Vec3f> pool(int side, int layers, double jitter) {
  test::Random random(3);
  std::vector<Vec3f> points;
  for (int i = 0; i < side; ++i)
    for (int j = 0; j < layers; ++j)
      for (int k = 0; k < side; ++k)
        points.push_back(Vec3f((Vec3d(i, -j, k) + random.point(-jitter, jitter)) * double{d}));
  return points;
}

SplatShapes shapes_of(std::span<const Vec3f> points, int threads = 2) {
  SplatShapes shapes(d);
  shapes.build(points, *make_threads(Threading::pool, threads));
  return shapes;
}

bool is_seen(const Mat3f& axes) {
  return determinant(axes) != 0;
}

/// Half the extent of an ellipsoid along a direction, |A^T n| [m].
float half_extent(const Mat3f& axes, const Vec3f& n) {
  return length(transpose(axes) * n);
}

/// Height of the highest point of all ellipsoids over (x, z), by |A^-1 (p - c)| = 1 [m].
float top_over(const SplatShapes& shapes, float x, float z) {
  float top = -1;
  for (std::size_t i = 0; i < shapes.centers().size(); ++i) {
    if (!is_seen(shapes.axes()[i])) continue;
    const Mat3f to_ball = inverse(shapes.axes()[i]);
    const Vec3f& c = shapes.centers()[i];
    const Vec3f from = to_ball * Vec3f{x - c.x, -c.y, z - c.z}, up = to_ball * Vec3f{0, 1, 0};
    const float a = dot(up, up), b = dot(from, up), root = b * b - a * (dot(from, from) - 1);
    if (root > 0) top = std::max(top, (std::sqrt(root) - b) / a);
  }
  return top;
}

TEST(SplatShapes, EndHalfASpacingAboveAPool) {
  for (const double jitter : {0.0, 0.15}) {
    const std::vector<Vec3f> points = pool(24, 6, jitter);
    const SplatShapes shapes = shapes_of(points);
    double sum = 0, squares = 0;
    const int samples = 20;
    for (int i = 0; i < samples; ++i)
      for (int k = 0; k < samples; ++k) {
        const auto at = [](int s) { return (8 + 0.4f * static_cast<float>(s)) * d; };
        const double height = double{top_over(shapes, at(i), at(k))} / double{d};
        sum += height, squares += height * height;
      }
    const double mean = sum / (samples * samples);
    EXPECT_NEAR(mean, 0.5, 0.1) << jitter;
    // Balls of radius 0.75 d, with the same mean height, deviate by 0.10 and 0.12.
    EXPECT_LT(std::sqrt(squares / (samples * samples) - mean * mean), 0.04) << jitter;
  }
}

TEST(SplatShapes, LieFlatInTheSurfaceAndDoNotReachBeyondEdges) {
  const std::vector<Vec3f> points = pool(24, 8, 0);
  const SplatShapes shapes = shapes_of(points);
  const auto at = [](int i, int j, int k) { return std::size_t((i * 8 + j) * 24 + k); };
  const Mat3f& top = shapes.axes()[at(12, 0, 12)];
  EXPECT_GT(half_extent(top, {1, 0, 0}), 2 * half_extent(top, {0, 1, 0}));
  EXPECT_NEAR(half_extent(top, {1, 0, 0}), half_extent(top, {0, 0, 1}), 0.01f * d);
  const Mat3f& side = shapes.axes()[at(0, 4, 12)];
  EXPECT_GT(half_extent(side, {0, 1, 0}), 2 * half_extent(side, {1, 0, 0}));
  for (std::size_t i = 0; i < points.size(); ++i) {
    EXPECT_LT(length(shapes.centers()[i] - points[i]), 0.5f * d);
    const Vec3f reached{half_extent(shapes.axes()[i], {1, 0, 0}), half_extent(shapes.axes()[i], {0, 1, 0}),
                        0};
    EXPECT_GT(shapes.centers()[i].x - reached.x, -0.8f * d);
    EXPECT_LT(shapes.centers()[i].y + reached.y, 0.8f * d);
  }
  EXPECT_FALSE(is_seen(shapes.axes()[at(12, 4, 12)])) << "with others all around";
}

TEST(SplatShapes, OfSheetsAreAllSeen) {
  for (const double jitter : {0.0, 0.15}) {
    const std::vector<Vec3f> sheet = pool(20, 1, jitter);
    const SplatShapes shapes = shapes_of(sheet);
    for (const Mat3f& axes : shapes.axes()) EXPECT_TRUE(is_seen(axes));
    const float half = half_extent(shapes.axes()[std::size_t(10 * 20 + 10)], {0, 1, 0});
    EXPECT_GT(half, 0.3f * d);
    EXPECT_LT(half, 0.7f * d);
  }
}

TEST(SplatShapes, OfSingleParticlesAreBallsOfTheirVolume) {
  const std::array<Vec3f, 2> drops{Vec3f{1, 2, 3}, Vec3f{1, 2.5f, 3}};
  const SplatShapes shapes = shapes_of(drops);
  for (std::size_t i = 0; i < drops.size(); ++i) {
    EXPECT_LT(length(shapes.centers()[i] - drops[i]), 1e-6f);
    const Mat3f& axes = shapes.axes()[i];
    EXPECT_NEAR(double{determinant(axes)} * 4 / 3 * pi, double{d * d * d}, 1e-3 * double{d * d * d});
    EXPECT_NEAR(half_extent(axes, {1, 0, 0}), half_extent(axes, normalized(Vec3f{1, 1, 1})), 1e-6f);
  }
}

TEST(SplatShapes, LeaveOutWhatIsNowhere) {
  std::vector<Vec3f> points = pool(8, 4, 0.1);
  const SplatShapes good = shapes_of(points);
  const float nan = std::numeric_limits<float>::quiet_NaN();
  points.insert(points.begin() + 5, Vec3f{nan, 0, 0});
  points.push_back({0, 1e30f, 0});
  const SplatShapes bad = shapes_of(points);
  ASSERT_EQ(bad.axes().size(), points.size());
  EXPECT_FALSE(is_seen(bad.axes()[5]));
  EXPECT_FALSE(is_seen(bad.axes().back()));
  EXPECT_EQ(bad.centers()[4], good.centers()[4]);
  EXPECT_EQ(bad.centers()[6], good.centers()[5]);
  EXPECT_TRUE(shapes_of({}).axes().empty());
}

TEST(SplatShapes, AllocateNothingWhenWarm) {
  const std::vector<Vec3f> points = pool(20, 20, 0.2);
  const auto threads = make_threads(Threading::pool, 2);
  SplatShapes shapes(d);
  shapes.build(points, *threads);
  const long before = test::allocations();
  shapes.build(points, *threads);
  EXPECT_EQ(test::allocations(), before);
}

TEST(SplatShapes, NeedASpacing) {
  EXPECT_THROW(SplatShapes{0}, Error);
  EXPECT_THROW(SplatShapes{std::numeric_limits<float>::quiet_NaN()}, Error);
}

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
    const Vec3d r = Vec3d(records[i].xyz()) - Vec3d(at.xyz());
    const double w = std::max(0.0, 1 - std::pow(length(r), 3));
    weight += w, first += w * r.y, xz += w * r.x * r.z;
  }
  const kernels::Moments found =
      kernels::find_surface_kernels(instruction_set()).moments(records.data(), at, list.data(), 32, 1);
  EXPECT_NEAR(double{found.weight}, weight, 1e-5);
  EXPECT_NEAR(double{found.first[1]}, first, 1e-5);
  EXPECT_NEAR(double{found.xz}, xz, 1e-5);
}

}  // namespace souple::test_surface_splat_shapes
