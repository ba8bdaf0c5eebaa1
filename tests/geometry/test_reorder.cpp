#include "checks.h"
#include "souple/geometry/adjacency.h"
#include "souple/geometry/builders.h"
#include "souple/geometry/reorder.h"

#include <algorithm>
#include <limits>
#include <numeric>

#include <gtest/gtest.h>

namespace souple::test_geometry_reorder {

// A grid with shuffled vertices, like meshes from modeling programs.
TriangleMesh shuffled_grid(int n) {
  TriangleMesh mesh = grid(n, n, 1);
  std::vector<std::uint32_t> order(mesh.positions.size());
  std::iota(order.begin(), order.end(), 0u);
  check::Random random(5);
  for (std::size_t i = order.size() - 1; i > 0; --i) std::swap(order[i], order[random.next() % (i + 1)]);
  TriangleMesh result;
  for (const std::uint32_t v : order) result.positions.push_back(mesh.positions[v]);
  const std::vector<std::uint32_t> now = inverse_order(order);
  for (const Triangle& t : mesh.triangles) result.triangles.push_back({now[t[0]], now[t[1]], now[t[2]]});
  return result;
}

// Mean distance in memory between the ends of an edge.
double mean_span(const std::vector<Edge>& edges, const std::vector<std::uint32_t>& order) {
  const std::vector<std::uint32_t> now = inverse_order(order);
  double sum = 0;
  for (const Edge& e : edges) {
    const std::uint32_t a = now[e[0]], b = now[e[1]];
    sum += std::max(a, b) - std::min(a, b);
  }
  return sum / double(edges.size());
}

bool is_permutation_of_all(std::vector<std::uint32_t> order, std::size_t count) {
  std::sort(order.begin(), order.end());
  for (std::size_t i = 0; i < order.size(); ++i)
    if (order[i] != i) return false;
  return order.size() == count;
}

TEST(Reorder, MortonBringsNeighborsTogether) {
  const TriangleMesh mesh = shuffled_grid(60);
  const std::vector<Edge> edges = unique_edges(mesh.triangles);
  std::vector<std::uint32_t> identity(mesh.positions.size());
  std::iota(identity.begin(), identity.end(), 0u);
  const std::vector<std::uint32_t> morton = morton_order(mesh.positions);
  EXPECT_TRUE(is_permutation_of_all(morton, mesh.positions.size()));
  EXPECT_GT(mean_span(edges, identity), 1000);
  EXPECT_LT(mean_span(edges, morton), 100);
}

TEST(Reorder, MortonVisitsTheEightOctantsInTurn) {
  std::vector<Vec3d> corners;
  for (int i = 7; i >= 0; --i) corners.push_back({double(i & 1), double(i >> 1 & 1), double(i >> 2)});
  EXPECT_EQ(morton_order(corners), (std::vector<std::uint32_t>{7, 6, 5, 4, 3, 2, 1, 0}));
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(morton_order(std::vector<Vec3d>{{nan, 0, 0}, {1, 1, 1}, {1, 1, 1}}),
            (std::vector<std::uint32_t>{1, 2, 0}));
}

}  // namespace souple::test_geometry_reorder
