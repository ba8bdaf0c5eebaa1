#pragma once

#include "souple/math/vec4.h"

#include <cstdint>
#include <vector>

namespace souple {

/// All particles of a world, as plain arrays of equal length; an object owns a contiguous range.
///
/// Two forms of time integration share these arrays (docs/architecture.md: small steps lose float digits):
/// - Plain form: during a substep, `position` is the predicted p and `start` is x, the position before
///   prediction; v = (p - start) / h.
/// - Displacement form: during a substep, `position` is x and does not change. `offset` is q, the sum of x's
///   rounding remainder and the displacement d. `start` is `offset` at the substep's start;
///   v = (q - start) / h. Then x += q is rounded, and `offset` keeps the remainder.
struct Particles {
  std::vector<Vec4f> position;  ///< x, y, z [m]; w: inverse mass [1/kg], 0: moved by targets only
  std::vector<Vec4f> offset;    ///< displacement form: q; plain form: 0 [m]
  std::vector<Vec4f> start;     ///< `position` (plain) or `offset` (displacement form) before prediction [m]
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
  bool has_spin() const { return !spin.empty(); }
  void add_spin() { spin.resize(size()), turn.resize(size()); }

  void resize(std::size_t count);
  void shrink_to_fit();
  /// Copies all data of particle `from` to particle `to`.
  void copy(std::size_t from, std::size_t to);
  /// Removes particles [begin, end).
  void erase(std::size_t begin, std::size_t end);
};

}  // namespace souple
