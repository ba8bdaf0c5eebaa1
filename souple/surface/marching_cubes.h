#pragma once

#include "souple/geometry/triangle_mesh.h"
#include "souple/surface/surface_field.h"

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace souple {

/// Triangles of one cube of eight nodes, for one pattern of inside nodes. Node k is at (k & 1, k >> 1 & 1, k
/// >> 2 & 1). Edge 4 a + b is along axis a. The lowest bit of b is its coordinate along the axis after a (x follows z).
/// The other bit is the coordinate along the axis after this one.
struct CubeCase {
  std::uint8_t triangle_count = 0;
  std::array<std::array<std::uint8_t, 3>, 12> triangles{};  ///< edges, counter-clockwise from outside
};
/// Marching cubes (Lorensen and Cline 1987). On a face whose inside nodes are diagonally opposite, the
/// surface separates them. Cubes on both sides of the face do the same, so the surface is closed. No edge
/// between two triangles of a cube is within a face, so no edge has more than two triangles: the surface is
/// manifold.
const std::array<CubeCase, 256>& cube_cases();

/// An indexed triangle mesh.
struct SurfaceMesh {
  std::vector<Vec3f> positions;     ///< m
  std::vector<Vec3f> normals;       ///< unit, outward
  std::vector<Triangle> triangles;  ///< counter-clockwise from outside
};

/// Extracts the surface of a field. Vertices are on the grid's edges, in the order of bricks, then axes, then
/// nodes. Each is then moved back by the mean shift of its kernels' centers from their particles.
class MarchingCubes {
 public:
  /// Allocates nothing when warm.
  void extract(const SurfaceField& field, SurfaceMesh& mesh, Threads& threads);
  /// Per vertex: ParticleKernel::crowd of the particles around it, averaged, in [0, 1].
  std::span<const float> crowd() const { return crowd_; }

 private:
  /// Edges that begin at nodes of a brick and cross the surface, by axis: bit n for the edge at node n.
  struct Cut {
    std::array<std::uint64_t, 3> edges;
    std::uint32_t first_vertex, first_triangle;
  };
  using Corner = std::array<std::uint32_t, 8>;  // the brick and its upper neighbors: x, y, xy, z, ...

  void find_cuts(const SurfaceField& field, Threads& threads);
  void number();
  void write_vertices(const SurfaceField& field, std::uint32_t brick, SurfaceMesh& mesh);
  void write_triangles(const SurfaceField& field, std::uint32_t brick, SurfaceMesh& mesh) const;
  std::uint32_t vertex(std::uint32_t brick, std::uint32_t node, std::size_t edge) const;

  std::vector<Cut> cuts_;
  std::vector<Corner> corners_;
  std::vector<float> crowd_;
  std::size_t vertex_count_ = 0, triangle_count_ = 0;
};

}  // namespace souple
