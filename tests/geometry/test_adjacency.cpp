#include "checks.h"
#include "souple/error.h"
#include "souple/geometry/adjacency.h"
#include "souple/geometry/builders.h"

#include <cmath>

#include <gtest/gtest.h>

namespace souple::test_geometry_adjacency {

TEST(Edges, OfTwoTrianglesInOrderOfFirstAppearance) {
  const std::vector<Triangle> triangles{{4, 7, 2}, {2, 7, 9}};
  const TriangleEdges edges = triangle_edges(triangles);
  EXPECT_EQ(edges.edges, (std::vector<Edge>{{4, 7}, {7, 2}, {2, 4}, {7, 9}, {9, 2}}));
  EXPECT_EQ(edges.of_triangle[1], (std::array<std::uint32_t, 3>{1, 3, 4}));
  EXPECT_EQ(unique_edges(triangles), edges.edges);
}

TEST(Edges, CountsFollowEuler) {
  const TriangleMesh ball = sphere(3, 1);
  EXPECT_EQ(unique_edges(ball.triangles).size(), ball.triangles.size() * 3 / 2);
  EXPECT_EQ(interior_edges(ball.triangles).size(), ball.triangles.size() * 3 / 2);
  EXPECT_TRUE(boundary_edges(ball.triangles).empty());
  const TriangleMesh sheet = grid(6, 4, 1);
  EXPECT_EQ(unique_edges(sheet.triangles).size(), 5u * 4 + 6 * 3 + 15);
  EXPECT_EQ(boundary_edges(sheet.triangles).size(), 2u * (5 + 3));
  EXPECT_EQ(interior_edges(sheet.triangles).size(), 53u - 16);
}

TEST(Edges, OfTetsFormASolidBall) {
  const TetMesh bar = tet_bar(3, 2, 2, {3, 2, 2});
  // V - E + F - T = 1 for a solid without holes.
  const std::size_t outside = surface_triangles(bar.tets).size();
  const std::size_t faces = (4 * bar.tets.size() + outside) / 2;
  EXPECT_EQ(
      long(bar.positions.size()) - long(unique_edges(bar.tets).size()) + long(faces) - long(bar.tets.size()),
      1);
}

TEST(Hinges, KeepOrientation) {
  // Both triangles of a hinge, read as (a, b, c) and (b, a, d), must face outward on a sphere.
  const TriangleMesh ball = sphere(2, 1);
  for (const auto& [a, b, c, d] : interior_edges(ball.triangles)) {
    const Vec3d &pa = ball.positions[a], &pb = ball.positions[b], &pc = ball.positions[c],
                &pd = ball.positions[d];
    EXPECT_GT(dot(cross(pb - pa, pc - pa), pa), 0);
    EXPECT_GT(dot(cross(pa - pb, pd - pb), pb), 0);
  }
}

TEST(Hinges, OfANonManifoldEdgePairNeighbors) {
  const std::vector<Triangle> book{{0, 1, 2}, {1, 0, 3}, {0, 1, 4}};
  EXPECT_EQ(interior_edges(book), (std::vector<Hinge>{{0, 1, 2, 3}, {1, 0, 3, 4}}));
  // Two triangles on the same corners have no hinge angle.
  EXPECT_TRUE(interior_edges(std::vector<Triangle>{{0, 1, 2}, {1, 0, 2}}).empty());
}

TEST(Edges, DegenerateTrianglesGiveNoLoop) {
  const TriangleEdges edges = triangle_edges(std::vector<Triangle>{{1, 1, 2}, {3, 3, 3}});
  EXPECT_EQ(edges.edges, (std::vector<Edge>{{1, 2}}));
  EXPECT_EQ(edges.of_triangle[0][0], TriangleEdges::no_edge);
}

TEST(VertexTriangles, AreThoseAroundAVertex) {
  const TriangleMesh sheet = grid(3, 3, 1);
  const Lists<std::uint32_t> around = vertex_triangles(sheet.triangles, 9);
  EXPECT_EQ(around[4].size(), 8u);  // the diagonals of a 3 x 3 grid meet in the center
  std::size_t sum = 0;
  for (std::size_t v = 0; v < 9; ++v)
    for (const std::uint32_t t : around[v]) {
      ++sum;
      const Triangle& triangle = sheet.triangles[t];
      EXPECT_TRUE(triangle[0] == v || triangle[1] == v || triangle[2] == v);
    }
  EXPECT_EQ(sum, 24u);
  EXPECT_THROW(vertex_triangles(sheet.triangles, 8), Error);
}

TEST(Components, AreNumberedByLowestVertex) {
  const std::vector<Triangle> triangles{{5, 6, 7}, {1, 2, 3}, {3, 8, 1}};
  const Components pieces = connected_components(triangles, 10);
  EXPECT_EQ(pieces.count, 5u);  // 0, {1 2 3 8}, 4, {5 6 7}, 9
  EXPECT_EQ(pieces.of_vertex, (std::vector<std::uint32_t>{0, 1, 1, 1, 2, 3, 3, 3, 1, 4}));
  EXPECT_EQ(connected_components(tet_bar(3, 3, 3, {1, 1, 1}).tets, 64).count, 1u);
}

TEST(CheckIndices, NamesTheCulprit) {
  TriangleMesh mesh = grid(2, 2, 1);
  mesh.triangles[1][2] = 99;
  try {
    check_indices(mesh, "flag.obj");
    FAIL();
  } catch (const Error& error) {
    EXPECT_STREQ(error.what(),
                 "flag.obj: triangle 1 names vertex 99, but there are 4 vertices (numbered from 0)");
  }
}

}  // namespace souple::test_geometry_adjacency
