#include "souple/fluid/cell_order.h"
#include "souple/fluid/kernels/find_kernels.h"
#include "souple/fluid/kernels/shapes.h"
#include "souple/fluid/neighbors.h"
#include "souple/fluid/smoothing.h"
#include "souple/simd/instruction_set.h"
#include "tests/count_allocations.h"
#include "tests/fluid/clouds.h"
#include "tests/instruction_sets.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <tuple>

#include <gtest/gtest.h>

namespace souple::test_fluid_neighbors {

std::vector<std::uint32_t> numbers(std::size_t n) {
  std::vector<std::uint32_t> result(n);
  std::iota(result.begin(), result.end(), 0u);
  return result;
}

TEST(CellOrder, IsByCellsAlongXFirstAndStable) {
  const auto threads = make_threads(Threading::pool, 2);
  const std::vector<Vec4f> points = test::random_cloud(20000, 1, 1);
  CellOrder order;
  order.build(points, 0.125f, *threads);  // a power of two: cells are exact
  const auto lo = [&](auto member) {
    return std::min_element(points.begin(), points.end(),
                            [&](auto& a, auto& b) { return a.*member < b.*member; });
  };
  const double x0 = lo(&Vec4f::x)->x, y0 = lo(&Vec4f::y)->y, z0 = lo(&Vec4f::z)->z;
  const auto cell = [&](std::uint32_t i) {
    return std::tuple(std::floor((points[i].z - z0) * 8), std::floor((points[i].y - y0) * 8),
                      std::floor((points[i].x - x0) * 8));
  };
  std::vector<std::uint32_t> expected = numbers(points.size());
  std::stable_sort(expected.begin(), expected.end(), [&](auto a, auto b) { return cell(a) < cell(b); });
  EXPECT_TRUE(std::equal(expected.begin(), expected.end(), order.order().begin(), order.order().end()));
  EXPECT_EQ(order.cell_count(), 512u);
  EXPECT_EQ(order.row_count(), 64u);
  for (std::size_t r = 0; r < order.row_count(); ++r) {
    for (std::uint32_t c = order.rows()[r].begin; c < order.rows()[r + 1].begin; ++c) {
      for (std::uint32_t k = order.cells()[c].begin; k < order.cells()[c + 1].begin; ++k) {
        const auto [z, y, x] = cell(order.order()[k]);
        EXPECT_EQ(z, order.rows()[r].z);
        EXPECT_EQ(y, order.rows()[r].y);
        EXPECT_EQ(x, order.cells()[c].x);
        EXPECT_EQ(order.component(2)[k], points[order.order()[k]].z);
      }
    }
  }
}

TEST(CellOrder, HoldsEveryParticleOnceWhateverTheyAre) {
  const auto threads = make_threads(Threading::pool, 2);
  for (const std::vector<Vec4f>& points :
       {std::vector<Vec4f>{}, std::vector<Vec4f>(1), std::vector<Vec4f>(300, Vec4f{1, 2, 3, 0}),
        test::ragged_cloud()}) {
    CellOrder order;
    order.build(points, 0.1f, *threads);
    std::vector<std::uint32_t> sorted(order.order().begin(), order.order().end());
    std::sort(sorted.begin(), sorted.end());
    EXPECT_EQ(sorted, numbers(points.size()));
    EXPECT_EQ(order.cells().back().begin, points.size());
    EXPECT_EQ(order.rows().back().begin, order.cell_count());
  }
}

TEST(CellOrder, AllocatesNothingWhenWarm) {
  const auto threads = make_threads(Threading::pool, 2);
  const std::vector<Vec4f> points = test::random_cloud(30000, 1, 6);
  CellOrder order;
  order.build(points, 0.05f, *threads);
  const long before = test::allocations();
  order.build(points, 0.05f, *threads);
  EXPECT_EQ(test::allocations(), before);
}

using Lists = std::vector<std::vector<std::uint32_t>>;

/// Lists by input particle, ascending.
Lists lists_of(const CellOrder& order, const Neighbors& neighbors) {
  Lists lists(order.size());
  std::uint32_t next = 0;
  for (const Neighbors::Block& block : neighbors.blocks()) {
    EXPECT_EQ(block.begin, next);
    next = block.end;
    for (std::uint32_t k = block.begin; k < block.end; ++k) {
      std::vector<std::uint32_t>& list = lists[order.order()[k]];
      for (const std::uint32_t entry : block.of(k)) list.push_back(order.order()[entry / 4]);
      EXPECT_EQ(block.padded(k).size() % Neighbors::padding, 0u);
      for (const std::uint32_t entry : block.padded(k).subspan(list.size()))
        EXPECT_EQ(entry, 4 * order.size());
      std::sort(list.begin(), list.end());
    }
  }
  EXPECT_EQ(next, order.size());
  return lists;
}

Lists brute_force(const std::vector<Vec4f>& points, float radius) {
  Lists lists(points.size());
  for (std::uint32_t i = 0; i < points.size(); ++i) {
    for (std::uint32_t j = 0; j < points.size(); ++j) {
      const Vec3f d = points[j].xyz() - points[i].xyz();
      if (i != j && d.x * d.x + d.y * d.y + d.z * d.z < radius * radius) lists[i].push_back(j);
    }
  }
  return lists;
}

Lists found(const std::vector<Vec4f>& points, float cell_size, float radius) {
  const auto pool = make_threads(Threading::pool, 2);
  CellOrder order;
  Neighbors neighbors;
  order.build(points, cell_size, *pool);
  neighbors.find(order, radius, *pool);
  return lists_of(order, neighbors);
}

TEST(Neighbors, AreThoseOfLookingAtAll) {
  const std::vector<Vec4f> points = test::random_cloud(4000, 1, 1);
  const Lists expected = brute_force(points, 0.12f);
  EXPECT_EQ(found(points, 0.12f, 0.12f), expected);
  EXPECT_EQ(found(points, 0.2f, 0.12f), expected);
  std::size_t sum = 0;
  for (const auto& list : expected) sum += list.size();
  EXPECT_NEAR(double(sum) / 4000, 4000 * 4.18879 * std::pow(0.12, 3), 6);  // fewer at the cube's walls
}

TEST(Neighbors, OfAFluidThatFlewApart) {
  const std::vector<Vec4f> points = test::ragged_cloud();
  EXPECT_EQ(found(points, 0.1f, 0.1f), brute_force(points, 0.1f));
  EXPECT_TRUE(found({}, 0.1f, 0.1f).empty());
}

// Coordinates end a million cells away: points beyond share cells, and their neighbors are still found.
TEST(Neighbors, BeyondTheGrid) {
  std::vector<Vec4f> points = test::random_cloud(200, 1, 2);
  for (const Vec4f& far : test::random_cloud(200, 1, 3)) points.push_back({far.x + 3e5f, far.y, far.z, 0});
  EXPECT_EQ(found(points, 0.1f, 0.1f), brute_force(points, 0.1f));
}

TEST(Neighbors, AllocatesNothingWhenWarm) {
  const auto threads = make_threads(Threading::pool, 2);
  const std::vector<Vec4f> points = test::random_cloud(20000, 1, 9);
  CellOrder order;
  Neighbors neighbors;
  order.build(points, 0.06f, *threads);
  neighbors.find(order, 0.06f, *threads);
  const long before = test::allocations();
  neighbors.find(order, 0.06f, *threads);
  EXPECT_EQ(test::allocations(), before);
}

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

// Also where two particles have one position: they push each other nowhere, and nothing becomes infinite.
TEST(FluidKernels, GiveTheSameBitsOnEveryInstructionSet) {
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
  const auto sums = [&](InstructionSet set, SmoothingShape shape, std::uint32_t i) {
    const auto sum = [&](const auto& function, const auto&... more) {
      return function(records.data(), values.data(), records[i], values[i], list.data(), list.size(),
                      smoothing.factors(), more...);
    };
    const auto density = kernels::find_density_kernels(set, shape)
                             .sums(records.data(), records[i], list.data(), list.size(), smoothing.factors());
    const auto& velocity = kernels::find_velocity_kernels(set, shape);
    return std::tuple(density.density, density.gradient, sum(velocity.exchange), sum(velocity.strain),
                      sum(velocity.curl), sum(velocity.closing_speed),
                      sum(velocity.cohesion, kernels::CohesionFactors{0.3f, 0.2f}));
  };
  for (const SmoothingShape shape : shapes)
    for (const std::uint32_t i : {0u, 7u, 100u, 299u}) {
      const auto scalar = sums(InstructionSet::scalar, shape, i);
      for (const InstructionSet set : all_sets())
        EXPECT_TRUE(sums(set, shape, i) == scalar) << simd_name(set);
      const auto& [density, gradient, exchange, strain, curl, closing_speed, cohesion] = scalar;
      EXPECT_TRUE(std::isfinite(density) && is_finite(gradient) && is_finite(strain) && is_finite(cohesion));
      EXPECT_GT(length(curl), 0);
      EXPECT_GT(closing_speed, 0);
    }
}

}  // namespace souple::test_fluid_neighbors
