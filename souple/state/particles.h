#pragma once

#include "souple/math/vec3.h"

#include <cstdint>
#include <vector>

namespace souple {

/// Sixteen bytes that a SIMD register loads whole: three components and a fourth lane.
struct alignas(16) Vec4f {
  float x{}, y{}, z{}, w{};

  Vec3f xyz() const { return {x, y, z}; }
  void set_xyz(const Vec3f& v) { x = v.x, y = v.y, z = v.z; }
};

/// All particles of a world, as plain arrays of equal length; an object owns a contiguous range.
///
/// Two ways to advance them share these arrays (docs/architecture.md: small steps eat float digits):
/// - plain form: during a substep `position` holds the predicted p and `start` the x it left;
///   v = (p - start) / h;
/// - displacement form: `position` holds x and stays, `offset` holds q = (what x cannot represent) + d, and
///   `start` the offset at the substep's beginning; v = (q - start) / h; then x += q rounds and `offset`
///   keeps the remainder.
struct Particles {
  std::vector<Vec4f> position;  ///< x, y, z [m], w = inverse mass [1/kg], 0 = moved by targets only
  std::vector<Vec4f> offset;    ///< displacement form: q [m]; zero in the plain form
  std::vector<Vec4f> start;     ///< what `position` (plain) or `offset` (displacement) was before prediction
  std::vector<Vec4f> velocity;  ///< m/s
  std::vector<float> mass;      ///< kg, kept for pinned particles too
  std::vector<float> radius;    ///< half thickness for contacts [m]
  std::vector<float> contact_margin;  ///< how far contacts of surfaces pushed it of late [m]

  std::size_t size() const { return position.size(); }

  void resize(std::size_t count);
  void shrink_to_fit();
  /// Makes particle `to` the same as particle `from`.
  void copy(std::size_t from, std::size_t to);
  /// Removes particles [begin, end).
  void erase(std::size_t begin, std::size_t end);
};

}  // namespace souple
