#include "souple/fluid/neighbors.h"
#include "tests/count_allocations.h"
#include "tests/fluid/clouds.h"

#include <algorithm>

#include <gtest/gtest.h>

namespace souple::test_fluid_neighbors {

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

}  // namespace souple::test_fluid_neighbors
