#pragma once

#include "souple/geometry/tet_mesh.h"
#include "souple/geometry/triangle_mesh.h"
#include "souple/math/lists.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace souple {

// Adjacency of mesh elements. All lists are in order of first appearance in the triangles (tets), corner by
// corner, so they depend on the mesh alone. Triangles with a repeated corner give no edge from a vertex to
// itself.

/// Two vertices.
using Edge = std::array<std::uint32_t, 2>;

/// Two triangles that share an edge: [edge a, edge b, opposite c, opposite d].
using Hinge = std::array<std::uint32_t, 4>;

/// The distinct edges, oriented as at first appearance (a then b in the triangle's or tet's order).
std::vector<Edge> unique_edges(std::span<const Triangle> triangles);
std::vector<Edge> unique_edges(std::span<const Tet> tets);

/// The distinct edges of triangles, and the edge of each triangle side. Side i joins corners i and (i + 1) %
/// 3; its edge is `no_edge` if it joins a vertex to itself.
struct TriangleEdges {
  static constexpr std::uint32_t no_edge = ~std::uint32_t(0);
  std::vector<Edge> edges;
  std::vector<std::array<std::uint32_t, 3>> of_triangle;
};
TriangleEdges triangle_edges(std::span<const Triangle> triangles);

/// Interior edges with their two opposite vertices, for bending. The first triangle is (a, b, c) in its
/// winding; the second is (b, a, d) if the surface is consistently wound. An edge shared by n > 2 triangles
/// gives n - 1 hinges, between consecutive triangles in mesh order. A flat hinge has two equal normals.
std::vector<Hinge> interior_edges(std::span<const Triangle> triangles);

/// Edges of exactly one triangle, in the direction of its winding.
std::vector<Edge> boundary_edges(std::span<const Triangle> triangles);

/// The triangles around each vertex, ascending. Throws Error if a triangle has a vertex index >= vertex_count.
Lists<std::uint32_t> vertex_triangles(std::span<const Triangle> triangles, std::size_t vertex_count);

/// Connected components, numbered by their lowest vertex. An unused vertex is a component of its own.
struct Components {
  std::vector<std::uint32_t> of_vertex;
  std::uint32_t count{};
};
/// Throws Error if an element has a vertex index >= vertex_count.
Components connected_components(std::span<const Edge> edges, std::size_t vertex_count);
Components connected_components(std::span<const Triangle> triangles, std::size_t vertex_count);
Components connected_components(std::span<const Tet> tets, std::size_t vertex_count);

/// Faces of exactly one tet, wound outward if tets are positively oriented; vertex indices are those of the
/// tet mesh.
std::vector<Triangle> surface_triangles(std::span<const Tet> tets);

/// Throws Error ("NAME: triangle 7 names vertex 12, but there are 10") if an index is out of range.
void check_indices(const TriangleMesh& mesh, const char* name = "mesh");
void check_indices(const TetMesh& mesh, const char* name = "mesh");

}  // namespace souple
