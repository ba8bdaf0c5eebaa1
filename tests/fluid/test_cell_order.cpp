#include "souple/fluid/cell_order.h"
#include "tests/count_allocations.h"
#include "tests/fluid/clouds.h"

#include <algorithm>
#include <numeric>
#include <tuple>

#include <gtest/gtest.h>

namespace souple::test_fluid_cell_order {

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

}  // namespace souple::test_fluid_cell_order
