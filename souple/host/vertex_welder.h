#pragma once

#include "souple/geometry/triangle_mesh.h"
#include "souple/host/placement.h"

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace souple::host {

/// A renderer's triangles, in its own memory: read during a call, never stored.
struct TriangleSoup {
  const float* positions = nullptr;  ///< x, y, z of each vertex, in mesh coordinates
  std::size_t vertex_count = 0;
  const std::uint32_t* indices = nullptr;  ///< three a triangle, counter-clockwise from outside
  std::size_t triangle_count = 0;
  std::size_t stride = 3;  ///< floats from one vertex to the next, >= 3
};

/// Kinds of normals for a renderer.
enum class Normals {
  welded,     ///< equal at all vertices of one position: smooth edges
  per_vertex  ///< from the triangles of the render vertex alone: hard edges where vertices are duplicated
};

/// Destination buffers of a renderer; either pointer may be nullptr.
struct VertexBuffers {
  float* positions = nullptr;  ///< x, y, z
  float* normals = nullptr;    ///< unit length; zero if all adjacent triangles have no area
  std::size_t stride = 3;      ///< floats from one vertex to the next in both buffers, >= 3
};

/// Maps render vertices to particles. A renderer duplicates vertices where normals or UVs differ, an importer
/// at each corner of each triangle; a simulation needs one particle per position. Render vertices, their
/// order and their triangles are unchanged.
class VertexWelder {
 public:
  /// Vertices of equal coordinates become one particle. With a `tolerance` (in mesh coordinates), so do
  /// vertices within it, joined as by weld_vertices in geometry/weld.h. Particles are in the order of their
  /// first render vertex. Throws Error, beginning with `name`, if there are no triangles, a position is not finite or
  /// an index is out of range. Also throws if the tolerance is not a number >= 0.
  explicit VertexWelder(const TriangleSoup& soup, double tolerance = 0, const std::string& name = "mesh");

  std::size_t vertex_count() const { return particle_of_.size(); }  ///< render vertices
  std::size_t particle_count() const { return positions_.size(); }
  std::size_t triangle_count() const { return render_triangles_.size(); }
  /// Per render vertex: its particle.
  const std::vector<std::uint32_t>& particle_of() const { return particle_of_; }
  const std::vector<Triangle>& render_triangles() const { return render_triangles_; }

  /// The mesh for a World: one vertex per particle, transformed by the placement. Triangles keep their order;
  /// a mirroring placement reverses their winding. Triangles with two equal corners are included; a World
  /// omits them. It treats non-manifold parts as those of a mesh file.
  TriangleMesh mesh(const Placement& placement = {}) const;

  /// Writes all render vertices in mesh coordinates, from the particles' world positions [m]. Normals are
  /// computed from the written positions and the renderer's triangles. Allocates only in the first call.
  /// Throws Error if a stride is too small.
  void write(const Vec3f* particles, const Placement& placement, const VertexBuffers& buffers,
             Normals normals = Normals::welded);

 private:
  void write_normals(const VertexBuffers& buffers, Normals normals);

  std::vector<std::uint32_t> particle_of_;
  std::vector<Vec3d> positions_;  // of particles, in mesh coordinates
  std::vector<Triangle> render_triangles_, triangles_;
  std::vector<Vec3f> placed_, normals_;  // scratch: of particles; of particles or render vertices
};

}  // namespace souple::host
