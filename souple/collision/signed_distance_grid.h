#pragma once

#include "souple/collision/signed_distance_field.h"

#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace souple {

/// Data of a signed distance field: points at origin + spacing (i, j, k), grouped into blocks.
struct SignedDistanceField::Grid {
  static constexpr int block_cells = 8;               // along each side of a block
  static constexpr int block_side = block_cells + 1;  // points; neighbors both store shared ones
  static constexpr std::size_t block_points = std::size_t(block_side) * block_side * block_side;
  static constexpr std::int32_t coarse_only = -1;

  Vec3d origin{};                  // [m]
  double spacing = 0;              // [m]
  std::array<int, 3> blocks{};     // number along each axis
  std::vector<float> corners;      // distances at the corners of blocks, x fastest [m]
  std::vector<std::int32_t> slot;  // per block: its number in `points`, or coarse_only
  std::vector<float> points;       // distances in blocks that store all points, block by block, x fastest [m]
  Vec3d lo{}, hi{};                // bounding box of the mesh [m]
  std::vector<Vec3d> mesh_positions;  // of the repaired mesh [m]
  std::vector<Triangle> mesh_triangles;
  std::vector<std::string> sentences;  // see SignedDistanceField

  /// Distance [m] and normal at a point inside the grid's box, given in cells from the origin.
  SurfaceDistance inside(const Vec3d& cells) const;
  /// The nearest point of the grid's box, both points in cells.
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
