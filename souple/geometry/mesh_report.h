#pragma once

#include "souple/geometry/adjacency.h"
#include "souple/geometry/triangle_mesh.h"
#include "souple/geometry/weld.h"

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace souple {

/// What is odd about an imported surface. Indices are the user's; edges are looked at after welding, so that
/// a UV seam is no hole, and are named by the lowest user vertices at their ends.
struct MeshReport {
  std::size_t vertex_count{}, triangle_count{};
  std::vector<std::uint32_t> non_finite_vertices;
  std::vector<std::uint32_t> unreferenced_vertices;  ///< in no triangle
  std::vector<std::uint32_t> duplicate_vertices;     ///< coincide with an earlier vertex
  std::vector<std::uint32_t> collapsed_triangles;    ///< two corners are one vertex
  /// Three corners on a line (height below 1e-10 of the length).
  std::vector<std::uint32_t> zero_area_triangles;
  std::vector<Edge> open_edges;          ///< in one triangle
  std::vector<Edge> non_manifold_edges;  ///< in three or more
  std::vector<Edge> inconsistent_edges;  ///< two triangles that wind against each other
  std::size_t pieces{};                  ///< separate parts, of vertices in use
  bool is_closed{};                      ///< has triangles, all finite, each edge in an even number of them
  double signed_volume{};                ///< m^3 where closed and consistently wound; 0 if not closed

  bool is_clean() const;
};

/// Looks a mesh over, joining vertices within `tolerance` meters (weld.h). Throws Error if an index is out of
/// range.
MeshReport inspect(const TriangleMesh& mesh, double tolerance);
/// The same, with rounding_tolerance.
MeshReport inspect(const TriangleMesh& mesh);

/// The report as sentences, one per oddity with its count and first place; none for a clean mesh.
std::vector<std::string> describe(const MeshReport& report);

/// Throws Error, with counts and places, unless the surface is closed. `name`: of the object or file.
void require_closed(const MeshReport& report, const std::string& name);

/// The surface that is simulated: welded, without what cannot move. The user's mesh stays as it is.
struct RepairedSurface {
  Weld weld;
  std::vector<Triangle> triangles;     ///< over welded vertices, consistently wound where that is possible
  std::vector<std::uint32_t> source;   ///< per triangle: its index among the user's
  std::vector<std::string> sentences;  ///< what was mended, and what could not be
};

/// Mends what can be: joins coincident vertices; drops collapsed triangles, exact copies of a triangle,
/// triangles with a vertex that is not finite, and (on an open surface; on a closed one they close it) those
/// of zero area; winds each piece consistently, as most of its triangles are, and closed pieces outward,
/// except that a closed piece inside a bigger one may be a cavity and stays. Throws Error if an index is out
/// of range.
RepairedSurface repair(const TriangleMesh& mesh, double tolerance);
RepairedSurface repair(const TriangleMesh& mesh);

}  // namespace souple
