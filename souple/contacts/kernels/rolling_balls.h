#pragma once

#include "souple/contacts/contact_law.h"
#include "souple/simd/registers.h"

// Include this only in translation units that are compiled for one instruction set. Every template here has
// the tag of its instruction set as an argument.

namespace souple::kernels {

template <class Isa, class Columns>
SOUPLE_INLINE inline ContactSums<Numbers<Isa>> load_sums(const Columns& columns, std::size_t i, int count) {
  return {load<Isa>(columns.normal_sum + i, count), load3<Isa>(columns.tangent_sum, i, count)};
}
template <class Isa, class Columns>
SOUPLE_INLINE inline void store_sums(const ContactSums<Numbers<Isa>>& sums, const Columns& columns,
                                     std::size_t i, int count) {
  store<Isa>(sums.normal_sum, columns.normal_sum + i, count);
  store3<Isa>(sums.tangent_sum, columns.tangent_sum, i, count);
}
template <class Isa>
SOUPLE_INLINE inline ContactSums<Numbers<Isa>> selected_sums(const typename Numbers<Isa>::Mask& mask,
                                                             const ContactSums<Numbers<Isa>>& a,
                                                             const ContactSums<Numbers<Isa>>& b) {
  return {select(mask, a.normal_sum, b.normal_sum), selected<Isa>(mask, a.tangent_sum, b.tangent_sum)};
}

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
        moment_sum(load3<Isa>(columns.moment_sum, i, count)),
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

/// solve_contact for a pack of contacts, and solve_rolling_contact for those of `acts` whose balls rotate.
/// `turn`: Particles::turn, or null. rotation(balls): of the balls relative to the other sides [m].
template <class Isa, class Columns, class Rotation>
SOUPLE_INLINE inline Vectors<Isa> solve_pack(ContactSums<Numbers<Isa>>& sums,
                                             const typename Numbers<Isa>::Mask& acts, const Numbers<Isa>& C,
                                             const Numbers<Isa>& slop, const Vectors<Isa>& n,
                                             const Vectors<Isa>& moved, float* turn, const Columns& columns,
                                             const std::uint32_t (&first_float)[Isa::lanes], std::size_t i,
                                             int count, const Rotation& rotation) {
  using T = Numbers<Isa>;
  ContactSums<T> rolling_sums = sums;
  const T static_friction = load<Isa>(columns.static_friction + i, count);
  const T kinetic_friction = load<Isa>(columns.kinetic_friction + i, count);
  const Vectors<Isa> change = solve_contact(sums, C, slop, n, moved, static_friction, kinetic_friction);
  if (!turn) return change;
  const RollingBalls<Isa> balls(turn, columns, first_float, i, count);
  const auto rolls = balls.rolls && acts;
  if (!any_lane(rolls)) return change;
  Vectors<Isa> moment_sum = balls.moment_sum;
  const auto rolling =
      solve_rolling_contact(rolling_sums, moment_sum, C, slop, n, balls.slip(moved, n), rotation(balls),
                            balls.response(), static_friction, kinetic_friction, balls.rolling_friction);
  sums.tangent_sum = selected<Isa>(rolls, rolling_sums.tangent_sum, sums.tangent_sum);
  store3<Isa>(selected<Isa>(rolls, moment_sum, balls.moment_sum), columns.moment_sum, i, count);
  balls.turn(rolling.friction, rolling.moment, rolls, turn, first_float, count);
  return selected<Isa>(rolls, rolling.position, change);
}

/// Likewise solve_restitution, and solve_rolling_restitution.
template <class Isa, class Columns, class Limits, class Rotation>
SOUPLE_INLINE inline Restitution<Numbers<Isa>> restitute_pack(
    const ContactSums<Numbers<Isa>>& sums, const typename Numbers<Isa>::Mask& acts, const Vectors<Isa>& n,
    const Vectors<Isa>& u, const Numbers<Isa>& approach, const Limits& limits, float* turn,
    const Columns& columns, const std::uint32_t (&first_float)[Isa::lanes], std::size_t i, int count,
    const Rotation& rotation) {
  using T = Numbers<Isa>;
  const T inverse_h(limits.inverse_h), threshold(limits.restitution_threshold);
  const T restitution = load<Isa>(columns.restitution + i, count);
  const T static_friction = load<Isa>(columns.static_friction + i, count);
  const T kinetic_friction = load<Isa>(columns.kinetic_friction + i, count);
  const Restitution<T> result = solve_restitution(sums, n, u, approach, threshold, restitution,
                                                  static_friction, kinetic_friction, inverse_h);
  if (!turn) return result;
  const RollingBalls<Isa> balls(turn, columns, first_float, i, count);
  const auto rolls = balls.rolls && acts;
  if (!any_lane(rolls)) return result;
  const T h = T(1.f) / inverse_h;
  const auto rolling = solve_rolling_restitution(
      sums, balls.moment_sum, n, dot(n, u), balls.slip(u * h, n) * inverse_h, rotation(balls) * inverse_h,
      balls.response(), approach, threshold, restitution, static_friction, kinetic_friction,
      balls.rolling_friction, inverse_h);
  balls.turn(rolling.change.friction * h, rolling.change.moment * h, rolls, turn, first_float, count);
  return {selected<Isa>(rolls, rolling.change.position, result.change), result.restitution_velocity};
}

}  // namespace souple::kernels
