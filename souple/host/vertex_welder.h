#pragma once

#include "souple/geometry/triangle_mesh.h"
#include "souple/host/placement.h"

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace souple::host {

/// A renderer's triangles, in its own memory: looked at during a call, never kept.
struct TriangleSoup {
  const float* positions = nullptr;  ///< x, y, z of each vertex, in the mesh's own coordinates
  std::size_t vertex_count = 0;
  const std::uint32_t* indices = nullptr;  ///< three a triangle, counter-clockwise from outside
  std::size_t triangle_count = 0;
  std::size_t stride = 3;  ///< floats from one vertex to the next, >= 3
};

/// Which normals a renderer is given.
enum class Normals {
  welded,     ///< of the surface: equal at all vertices of one place, so edges look smooth
  per_vertex  ///< of the triangles that name the render vertex itself: hard where the renderer doubled it
};

/// Where a renderer wants its vertices; either may be nullptr.
struct VertexBuffers {
  float* positions = nullptr;  ///< x, y, z
  float* normals = nullptr;    ///< unit; zero where all triangles around are without area
  std::size_t stride = 3;      ///< floats from one vertex to the next, of both, >= 3
};

/// A renderer doubles vertices where normals or UVs differ, an importer one for each corner of each triangle;
/// what moves is one particle for each place. This joins them, and gives each render vertex its particle's
/// position. Render vertices, their order and triangles stay as they are.
class VertexWelder {
 public:
  /// Vertices of equal coordinates become one particle, or those within `tolerance` (in the mesh's own
  /// coordinates) as weld_vertices in geometry/weld.h joins them. Particles are numbered by their lowest
  /// render vertex. Throws Error, beginning with `name`, when there are no triangles, a position is not
  /// finite, an index is out of range, or the tolerance is not a number >= 0.
  explicit VertexWelder(const TriangleSoup& soup, double tolerance = 0, const std::string& name = "mesh");

  std::size_t vertex_count() const { return particle_of_.size(); }  ///< of the renderer
  std::size_t particle_count() const { return positions_.size(); }
  std::size_t triangle_count() const { return render_triangles_.size(); }
  /// Per render vertex.
  const std::vector<std::uint32_t>& particle_of() const { return particle_of_; }
  const std::vector<Triangle>& render_triangles() const { return render_triangles_; }

  /// What a World takes: one vertex per particle, where the placement puts it; triangles in their order,
  /// wound the other way when the placement mirrors. Triangles that lost a corner are still among them: a
  /// World leaves them out, and takes what is not manifold as it does from a file.
  TriangleMesh mesh(const Placement& placement = {}) const;

  /// Writes every render vertex, in the mesh's own coordinates, from positions in the world [m], one per
  /// particle. Normals are those of the positions written, by the renderer's triangles. Allocates nothing
  /// after the first time. Throws Error when a stride is too small.
  void write(const Vec3f* particles, const Placement& placement, const VertexBuffers& buffers,
             Normals normals = Normals::welded);

 private:
  void write_normals(const VertexBuffers& buffers, Normals normals);

  std::vector<std::uint32_t> particle_of_;
  std::vector<Vec3d> positions_;  // of particles, in the mesh's coordinates
  std::vector<Triangle> render_triangles_, triangles_;
  std::vector<Vec3f> placed_, normals_;  // scratch: of particles; of particles or render vertices
};

}  // namespace souple::host
