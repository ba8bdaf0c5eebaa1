#pragma once

#include "souple/contacts/contact_law.h"
#include "souple/simd/registers.h"

// Include this only in translation units that are compiled for one instruction set. Every template here has
// the tag of its instruction set as an argument.

namespace souple::kernels {

/// A pack of contacts of balls that rotate with surfaces: values and rotations of the balls. Lanes without such a ball
/// have share 0 and regular values.
template <class Isa>
struct RollingBalls {
  using T = Numbers<Isa>;
  T share, rolling_friction;
  typename T::Mask rolls;
  Vectors<Isa> moment_sum;
  Vectors<Isa> turned;  ///< Particles::turn [m]

  /// `columns`: of contacts, with share, rolling_friction and moment_sum.
  template <class Columns>
  SOUPLE_INLINE RollingBalls(const float* turn, const Columns& columns,
                             const std::uint32_t (&first_float)[Isa::lanes], std::size_t i, int count)
      : share(load<Isa>(columns.share + i, count)),
        rolling_friction(load<Isa>(columns.rolling_friction + i, count)),
        rolls(share > T(0.f)),
        moment_sum{load<Isa>(columns.moment_sum[0] + i, count), load<Isa>(columns.moment_sum[1] + i, count),
                   load<Isa>(columns.moment_sum[2] + i, count)},
        turned(Records<Isa>(turn, first_float).components()) {}

  /// Displacement at the point of contact, cross n. `moved`: that of the ball's center relative to the surface.
  SOUPLE_INLINE Vectors<Isa> slip(const Vectors<Isa>& moved, const Vectors<Isa>& n) const {
    return cross(moved, n) + (turned - n * dot(n, turned));
  }

  /// The moment arm is the ball's radius.
  SOUPLE_INLINE RollingResponse<T> response() const {
    const T s = select(rolls, share, T(1.f));
    return {s + T(1.f), s, s};
  }

  template <class Columns>
  SOUPLE_INLINE void store_sum(const Vectors<Isa>& sum, const typename T::Mask& which, const Columns& columns,
                               std::size_t i, int count) const {
    for (int axis = 0; axis < 3; ++axis)
      store<Isa>(select(which, sum[axis], moment_sum[axis]), columns.moment_sum[axis] + i, count);
  }

  /// Turns the balls of the lanes `which`. Writes to no other particle: lanes may share one that cannot move.
  SOUPLE_INLINE void turn(const Vectors<Isa>& friction, const Vectors<Isa>& moment,
                          const typename T::Mask& which, float* base,
                          const std::uint32_t (&first_float)[Isa::lanes], int count) const {
    float component[3][Isa::lanes], writes[Isa::lanes];
    select(which, T(1.f), T(0.f)).store(writes);
    const Vectors<Isa> after = turned + (friction + moment) * share;
    for (int axis = 0; axis < 3; ++axis) after[axis].store(component[axis]);
    for (int lane = 0; lane < count; ++lane)
      for (std::uint32_t axis = 0; writes[lane] > 0 && axis < 3; ++axis)
        base[first_float[lane] + axis] = component[axis][lane];
  }
};

}  // namespace souple::kernels
