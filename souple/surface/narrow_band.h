#pragma once

#include "souple/geometry/triangle_mesh.h"
#include "souple/threads/threads.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace souple {

/// A narrow-band level set: signed distances to a surface, negative inside, at nearby points of a grid. The
/// grid's points are the multiples of `cell`. They are in bricks of 8 x 8 x 8; the brick of the origin has
/// points 0 to 7 along each axis.
struct NarrowBand {
  static constexpr int side = 8;
  static constexpr std::size_t brick_points = std::size_t{side} * side * side;

  struct Brick {
    std::array<std::int32_t, 3> first{};          ///< lowest point of the brick, in cells
    std::array<float, brick_points> distances{};  ///< at index 64 x + 8 y + z [m]; `width` outside the band
    /// Whether a point is nearer to the surface than `width`.
    bool in_band(std::size_t point) const { return (band[point / 64] >> point % 64 & 1) != 0; }
    std::array<std::uint64_t, brick_points / 64> band{};
  };

  float cell = 0;             ///< spacing of the points [m]
  float width = 0;            ///< of the band on each side of the surface [m]
  std::vector<Brick> bricks;  ///< in order of z, then y, then x; all have points in the band
};

/// The band around a closed surface, `width` cells wide on each side (1 to 100). `triangles`:
/// counter-clockwise from outside. Distances are exact except for the rounding to float. Points are inside
/// where the surface's winding number is above one half (MeshTree), so pieces may overlap, have cavities, and
/// be inside them. The result does not depend on the number of threads.
///
/// Throws Error if a position is not finite or further than 8 million cells from the origin. Also throws if `cell` is
/// not a positive length, or `width` is out of range.
NarrowBand narrow_band(std::span<const Vec3f> positions, std::span<const Triangle> triangles, float cell,
                       int width, Threads& threads);

}  // namespace souple
