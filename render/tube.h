#pragma once

#include "souple/geometry/triangle_mesh.h"
#include "souple/math/vec3.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace souple::render {

/// The surface of a rope: a closed tube with round caps around a smooth curve through the rope's points.
///
/// Each row is a ring of `sides` + 1 vertices, the last at the position of the first, so that a pattern can
/// run around the tube. Apart from that seam the surface is closed, with outward orientation.
class Tube {
 public:
  static constexpr std::uint32_t sides = 16;

  /// Builds a tube for this many points (a single point gives a ball). Sets triangles and texture; `radius`
  /// and `length` [m] of the rope determine the number of fields of the pattern.
  void resize(std::size_t points, float radius, float length);
  /// Sets positions and normals from the points; their number must be that of `resize`. Points may coincide.
  void update(std::span<const Vec3f> points, float radius);

  std::span<const Vec3f> positions() const { return positions_; }
  std::span<const Vec3f> normals() const { return normals_; }
  std::span<const Triangle> triangles() const { return triangles_; }
  /// A checker of size 1 at these coordinates forms two strands around the rope.
  std::span<const Vec3f> texture() const { return texture_; }

  /// Position of a vertex along the rope: point index plus fraction.
  float parameter(std::size_t vertex) const;
  /// The rope's point nearest to a vertex, measured along the rope.
  std::uint32_t point_of(std::size_t vertex) const;

 private:
  /// A cross-section: its center, the tangent `along` the rope, and the directions that span the section.
  struct Frame {
    Vec3f center, along, across, up;
  };

  std::size_t ring_count() const { return frames_.size() + 2 * (cap_rings - 1); }
  void sample_curve(std::span<const Vec3f> points);
  void set_tangents();
  void propagate_frames();
  void set_ring(std::size_t ring, const Frame& frame, float angle, float radius);

  static constexpr std::size_t cap_rings = 4;  ///< rings from a rim to its pole
  static constexpr std::uint32_t row = sides + 1;

  std::size_t points_ = 0;
  std::uint32_t steps_ = 1;  ///< rings per segment
  std::vector<Frame> frames_;
  std::vector<Vec3f> positions_, normals_, texture_;
  std::vector<Triangle> triangles_;
};

}  // namespace souple::render
