#pragma once

#include "souple/geometry/adjacency.h"
#include "souple/geometry/triangle_mesh.h"
#include "souple/geometry/weld.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace souple {

/// Defects of an imported surface. Indices are the user's. Edges are examined after welding, so that a UV
/// seam is no hole; an edge is identified by the lowest user vertices at its ends.
struct MeshReport {
  std::size_t vertex_count{}, triangle_count{};
  std::vector<std::uint32_t> non_finite_vertices;
  std::vector<std::uint32_t> unreferenced_vertices;  ///< in no triangle
  std::vector<std::uint32_t> duplicate_vertices;     ///< coincident with an earlier vertex
  std::vector<std::uint32_t> collapsed_triangles;    ///< two corners coincide
  /// Three collinear corners (height below 1e-10 of the length).
  std::vector<std::uint32_t> zero_area_triangles;
  std::vector<Edge> open_edges;          ///< of one triangle
  std::vector<Edge> non_manifold_edges;  ///< of three or more triangles
  std::vector<Edge> inconsistent_edges;  ///< of two triangles with opposite winding
  std::size_t pieces{};                  ///< connected components of used vertices
  bool is_closed{};        ///< has triangles, all finite, and each edge has an even number of them
  double signed_volume{};  ///< m^3 if closed and consistently wound; 0 if not closed

  bool is_clean() const;
};

/// Inspects a mesh, welding vertices within `tolerance` meters (weld.h). Throws Error if an index is out of
/// range.
MeshReport inspect(const TriangleMesh& mesh, double tolerance);
/// Inspects with rounding_tolerance.
MeshReport inspect(const TriangleMesh& mesh);

/// The report as sentences, one per kind of defect with its count and first location; none for a clean mesh.
std::vector<std::string> describe(const MeshReport& report);

/// Throws Error, with counts and locations, unless the surface is closed. `name`: of the object or file;
/// `holes`: describe(holes) of close_holes.h, may be empty.
void require_closed(const MeshReport& report, const std::string& name, const std::string& holes = {});

/// The simulated surface: welded, without degenerate triangles. The user's mesh is unchanged.
struct RepairedSurface {
  Weld weld;
  std::vector<Triangle> triangles;     ///< over welded vertices, consistently wound if possible
  std::vector<std::uint32_t> source;   ///< per triangle: its index in the user's mesh
  std::vector<std::string> sentences;  ///< repairs, and defects that remain
};

/// Repairs a mesh. Joins coincident vertices. Drops collapsed triangles, duplicate triangles, triangles with
/// a non-finite vertex and, unless they close the surface, triangles without area. Winds each piece consistently, like
/// the majority of its triangles, and closed pieces outward. A closed piece inside a larger one may be a cavity and
/// keeps its winding. Throws Error if an index is out of range.
RepairedSurface repair(const TriangleMesh& mesh, double tolerance);
RepairedSurface repair(const TriangleMesh& mesh);

/// Winds triangles over welded vertices as `repair` does. Returns sentences of what it reversed.
std::vector<std::string> wind_consistently(std::span<const Vec3d> positions,
                                           std::vector<Triangle>& triangles);

}  // namespace souple
