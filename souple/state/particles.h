#pragma once

#include "souple/math/vec4.h"

#include <cstdint>
#include <span>
#include <vector>

namespace souple {

struct IndexRange;

/// The position of a record plus its displacement, without rounding to float [m].
inline Vec3d exact_sum(const Vec4f& position, const Vec4f& displacement) {
  return Vec3d(position.xyz()) + Vec3d(displacement.xyz());
}

/// All particles of a world, as plain arrays of equal length; an object owns a contiguous range.
///
/// Small steps lose float digits (docs/architecture.md), so the solver moves displacements. During a substep,
/// `position` is x and does not change. `offset` is q, the sum of x's rounding remainder and the displacement d.
/// `start` is `offset` at the substep's start; v = (q - start) / h. Then x += q is rounded, and `offset` keeps the
/// remainder.
struct Particles {
  std::vector<Vec4f> position;  ///< x, y, z [m]; w: inverse mass [1/kg], 0: moved by targets only
  std::vector<Vec4f> offset;    ///< q [m]
  std::vector<Vec4f> start;     ///< `offset` before prediction [m]
  std::vector<Vec4f> velocity;  ///< [m/s]
  std::vector<float> mass;      ///< [kg], of pinned particles too
  std::vector<float> radius;    ///< half the thickness in contacts [m]
  /// Radius at rest of the smallest circle around the largest triangle or segment that has the particle as a
  /// corner; 0: none [m].
  std::vector<float> element_radius;
  /// By how much its surface contacts begin earlier, after recent strong corrections by such contacts [m].
  std::vector<float> contact_margin;

  // Rotation of grains. Both arrays are empty until has_spin(): worlds without grains pay nothing.
  std::vector<Vec4f> spin;  ///< angular velocity; 0 unless the particle is a grain [rad/s]
  /// During a substep: displacement of a grain's surface by its rotation, the radius times the angle turned [m].
  std::vector<Vec4f> turn;

  std::size_t size() const { return position.size(); }
  /// Position of a particle, including the part beyond float precision [m].
  Vec3d exact_position(std::size_t i) const { return exact_sum(position[i], offset[i]); }
  bool has_spin() const { return !spin.empty(); }
  void add_spin() { spin.resize(size()), turn.resize(size()); }

  void resize(std::size_t count);
  void shrink_to_fit();
  /// Copies all data of particle `from` to particle `to`.
  void copy(std::size_t from, std::size_t to);
  /// Removes the particles of ranges, ascending.
  void erase(std::span<const IndexRange> ranges);
};

}  // namespace souple
