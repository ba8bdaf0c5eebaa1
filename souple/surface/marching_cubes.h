#pragma once

#include "souple/geometry/triangle_mesh.h"
#include "souple/surface/surface_field.h"

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace souple {

/// What a cube of eight nodes adds to a surface, by which of them are inside: node k lies at (k & 1,
/// k >> 1 & 1, k >> 2 & 1). Edge 4 a + b runs along axis a; b's lowest bit is where it lies along the axis
/// after a (z before x again), the other where along the one after that.
struct CubeCase {
  std::uint8_t triangle_count = 0;
  std::array<std::array<std::uint8_t, 3>, 12> triangles{};  ///< edges, counter-clockwise from outside
};
/// Marching cubes (Lorensen and Cline 1987). Where inside and outside meet crosswise on a face of the cube,
/// the nodes inside are parted: cubes on both sides of the face cut it alike, so the surface is closed. No
/// side of two triangles lies within a face, so none is shared by more than two: the surface is manifold.
const std::array<CubeCase, 256>& cube_cases();

/// A surface whose corners are shared.
struct SurfaceMesh {
  std::vector<Vec3f> positions;     ///< m
  std::vector<Vec3f> normals;       ///< of length 1, outwards
  std::vector<Triangle> triangles;  ///< counter-clockwise from outside
};

/// Cuts the surface out of a field. Vertices lie on the grid's edges, in the order of bricks, then of axes
/// and nodes; then each goes back the way that its kernels' centers went from their particles.
class MarchingCubes {
 public:
  /// Allocates nothing when warm.
  void extract(const SurfaceField& field, SurfaceMesh& mesh, Threads& threads);
  /// Of each vertex: how crowded the particles around it are, in [0, 1].
  std::span<const float> crowd() const { return crowd_; }

 private:
  /// Edges that begin at nodes of a brick and are cut, by axis.
  struct Cut {
    std::array<std::uint64_t, 3> edges;
    std::uint32_t first_vertex, first_triangle;
  };
  using Corner = std::array<std::uint32_t, 8>;  // the brick and those at its far sides: x, y, xy, z, ...

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
