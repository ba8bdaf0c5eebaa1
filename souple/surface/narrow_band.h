#pragma once

#include "souple/geometry/triangle_mesh.h"
#include "souple/solver/threads.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace souple {

/// Signed distances to a surface at the points of a grid near to it, negative inside: a level set. The
/// grid's points are the multiples of `cell`; they come in bricks of 8 x 8 x 8, those of the origin's brick
/// being 0 to 7 along each axis.
struct NarrowBand {
  static constexpr int side = 8;
  static constexpr std::size_t brick_points = std::size_t{side} * side * side;

  struct Brick {
    std::array<std::int32_t, 3> first{};          ///< its lowest point, in cells
    std::array<float, brick_points> distances{};  ///< at 64 x + 8 y + z [m]; `width` where not in the band
    /// Whether that point is nearer to the surface than `width`.
    bool in_band(std::size_t point) const { return (band[point / 64] >> point % 64 & 1) != 0; }
    std::array<std::uint64_t, brick_points / 64> band{};
  };

  float cell = 0;             ///< m
  float width = 0;            ///< of the band on each side of the surface [m]
  std::vector<Brick> bricks;  ///< in order of z, then y, then x; each has points in the band
};

/// The band around a closed surface, `width` cells wide on each side (at least 1). `triangles`
/// counter-clockwise from outside; distances are those to the triangles, exact but for the rounding to float.
/// Inside is what the surface goes around more than half a time (MeshTree), so pieces may overlap, hold
/// cavities, and lie in them. The same for any number of threads.
///
/// Throws Error where a position is not finite or further than 8 million cells from the origin, or `cell` or
/// `width` makes no sense.
NarrowBand narrow_band(std::span<const Vec3f> positions, std::span<const Triangle> triangles, float cell,
                       int width, Threads& threads);

}  // namespace souple
