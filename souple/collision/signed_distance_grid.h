#pragma once

#include "souple/collision/signed_distance_field.h"

#include <array>
#include <cstdint>

namespace souple {

/// What a signed distance field holds: points at origin + spacing (i, j, k), grouped into blocks.
struct SignedDistanceField::Grid {
  static constexpr int block_cells = 8;               // along each side
  static constexpr int block_side = block_cells + 1;  // points; neighbors repeat those they share
  static constexpr std::size_t block_points = std::size_t(block_side) * block_side * block_side;
  static constexpr std::int32_t coarse_only = -1;

  Vec3d origin{};                     // [m]
  double spacing = 0;                 // [m]
  std::array<int, 3> blocks{};        // along each axis
  std::vector<float> corners;         // distances at the corners of blocks, x fastest [m]
  std::vector<std::int32_t> slot;     // of each block among those that hold all their points
  std::vector<float> points;          // their distances, block by block, x fastest [m]
  Vec3d lo{}, hi{};                   // of the mesh [m]
  std::vector<Vec3d> mesh_positions;  // as mended
  std::vector<Triangle> mesh_triangles;

  /// At a point of the grid's box, counted in cells from the origin.
  SurfaceDistance inside(const Vec3d& cells) const;
  /// The point of the box nearest to one, both counted in cells.
  Vec3d clamped(const Vec3d& cells) const;

  std::size_t block_index(int i, int j, int k) const {
    return (std::size_t(k) * std::size_t(blocks[1]) + std::size_t(j)) * std::size_t(blocks[0]) +
           std::size_t(i);
  }
  std::size_t corner_index(int i, int j, int k) const {
    return (std::size_t(k) * std::size_t(blocks[1] + 1) + std::size_t(j)) * std::size_t(blocks[0] + 1) +
           std::size_t(i);
  }
};

}  // namespace souple
