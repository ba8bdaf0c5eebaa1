#pragma once

#include "souple/contacts/contact_material.h"
#include "souple/math/vec3.h"

// When a contact begins; its friction and restitution, for T = float or a pack of floats. Both give the same bits.

namespace souple {

/// Contacts begin this part of their distance before sides touch, because the solver moves the sides too.
inline constexpr float speculative_part = 0.1f;

/// Coulomb's law for sums over a substep. `sticking` is the tangential correction that would stop all
/// sliding. It is returned unchanged up to mu_s times the normal correction. Beyond that limit the contact
/// slides, and the result is cut to mu_k times the normal correction. Both corrections have one unit, m or
/// m/s.
template <class T>
Vec3<T> within_friction(const Vec3<T>& sticking, T static_friction, T kinetic_friction, T normal) {
  const T size = length(sticking);
  const auto sticks = size <= static_friction * normal;
  return sticking * select(sticks, T(1), kinetic_friction * normal / select(sticks, T(1), size));
}

/// The kinetic coefficient belongs to sides that slide. Sides that move by less than `threshold` [m] relative to each
/// other in the substep stick or begin to slide, so both limits are static. Otherwise a body whose particles are
/// pressed on one after the other would never stick.
inline float kinetic_friction_at(const ContactMaterialPair& material, const Vec3f& relative_motion,
                                 float threshold) {
  return length_squared(relative_motion) > threshold * threshold ? material.kinetic_friction
                                                                 : material.static_friction;
}

/// Corrections that a contact has applied since the substep began.
template <class T>
struct ContactSums {
  T normal_sum;         ///< sum of normal corrections of the relative position, never negative [m]
  Vec3<T> tangent_sum;  ///< sum of tangential corrections of the relative position [m]
};

/// Normal impulse of a contact in the substep: what its corrections and its restitution changed, times the effective
/// mass [N s]. `restitution_velocity`: normal velocity that restitution added [m/s].
inline float normal_impulse(float normal_sum, float restitution_velocity, float inverse_h,
                            float inverse_mass) {
  return (normal_sum * inverse_h + restitution_velocity) / inverse_mass;
}

/// Whether a contact that pushes makes its sides bounce. `approach`: speed of the predicted motion [m/s].
inline bool bounces(float normal_sum, float restitution, float approach, float threshold) {
  return normal_sum > 0 && restitution > 0 && approach > threshold;
}

/// One projection of C >= slop with friction (Macklin et al. 2014, section 6.1). Updates the sums and returns
/// their change, which is the correction of the relative position [m]. `motion`: of the first side relative
/// to the second since the substep began [m]. A correction that a neighboring contact made too large is
/// partly undone, but the normal sum never falls below 0: contacts do not pull.
template <class T>
Vec3<T> solve_contact(ContactSums<T>& sums, T C, T slop, const Vec3<T>& n, const Vec3<T>& motion,
                      T static_friction, T kinetic_friction) {
  const T zero(0);
  const T dn = max(slop - C, -sums.normal_sum);
  const T normal_sum = sums.normal_sum + dn;
  const auto active = normal_sum > zero;
  const Vec3<T> sticking = sums.tangent_sum - n * dot(n, sums.tangent_sum) - (motion - n * dot(n, motion));
  Vec3<T> tangent_sum = within_friction(sticking, static_friction, kinetic_friction, normal_sum);
  for (int axis = 0; axis < 3; ++axis) tangent_sum[axis] = select(active, tangent_sum[axis], zero);
  const Vec3<T> change = n * dn + (tangent_sum - sums.tangent_sum);
  sums = {select(active, normal_sum, zero), tangent_sum};
  return change;
}

inline Vec3f solve_contact(ContactSums<float>& sums, float C, float slop, const Vec3f& n, const Vec3f& motion,
                           const ContactMaterialPair& material) {
  return solve_contact(sums, C, slop, n, motion, material.static_friction, material.kinetic_friction);
}

/// A contact whose balls rotate: the change of displacement and of rotation per correction.
///
/// Two balls i and j of radius r and inverse mass w touch; I = 2/5 m r^2. Their rotations are surface displacements
/// S = r theta. An impulse lambda tangential to the contact and a moment tau about it change
///   d(x_i - x_j) = (w_i + w_j) lambda
///   dS_i = share_i (dF + arm_i dG),   dS_j = share_j (dF - arm_j dG),   share = 5/2 w / (w_i + w_j)
/// with F = (w_i + w_j) lambda x n, G = (w_i + w_j) tau / r0 and arm = r0 / r. The length r0 is the moment arm of
/// rolling friction per coefficient. A side that does not rotate has share 0. The displacement at the point of
/// contact, slip x n, and the relative rotation, r0 (theta_i - theta_j), then change by
///   slip x n:  A dF + c dG,    roll:  c dF + B dG.
inline constexpr float inverse_inertia_factor = 2.5f;  // m r^2 / I of a solid ball

template <class T>
struct RollingResponse {
  T A, c, B;
};

/// Corrections of F and G since the substep began, and their new values.
template <class T>
struct RollingSums {
  Vec3<T> friction;  ///< F [m]
  Vec3<T> moment;    ///< G [m]
};

/// F and G that stop slip and roll, with F within Coulomb's law and |G| <= mu_r times the normal correction. G is the
/// constant directional moment of Zhou et al. 1999, "Rolling friction in the dynamic simulation of sandpile formation",
/// eq. 9. It acts against the relative rotation (Ai et al. 2011, model A), and sticks below its limit. `slip`:
/// displacement at the point of contact, cross n. Solved as a block: where rolling sticks, a ball on a plane has its
/// whole mass, otherwise 2/7 of it. One after the other, a ball held by rolling friction would creep down a slope.
template <class T>
RollingSums<T> solve_rolling(const RollingSums<T>& sums, const RollingResponse<T>& response, const Vec3<T>& n,
                             const Vec3<T>& slip, const Vec3<T>& roll, T static_friction, T kinetic_friction,
                             T rolling_friction, T normal) {
  const auto& [A, c, B] = response;
  const T one(1);
  const auto tangential = [&n](const Vec3<T>& v) { return v - n * dot(n, v); };
  const Vec3<T> slip0 = slip - sums.friction * A - tangential(sums.moment) * c;
  const Vec3<T> roll0 = roll - sums.friction * c - sums.moment * B;
  const T c_B = c / B;
  const Vec3<T> stuck = within_friction((tangential(roll0) * c_B - slip0) * (one / (A - c * c_B)),
                                        static_friction, kinetic_friction, normal);
  const Vec3<T> moment =
      within_friction((roll0 + stuck * c) * (-one / B), rolling_friction, rolling_friction, normal);
  return {within_friction((slip0 + tangential(moment) * c) * (-one / A), static_friction, kinetic_friction,
                          normal),
          moment};
}

/// Changes by one projection of a contact that rolls.
template <class T>
struct RollingChange {
  Vec3<T> position;          ///< of the relative position [m]
  Vec3<T> friction, moment;  ///< of F and G [m]
};

/// As solve_contact, for balls that rotate. `moment_sum`: G. `slip` and `roll` as in solve_rolling.
template <class T>
RollingChange<T> solve_rolling_contact(ContactSums<T>& sums, Vec3<T>& moment_sum, T C, T slop,
                                       const Vec3<T>& n, const Vec3<T>& slip, const Vec3<T>& roll,
                                       const RollingResponse<T>& response, T static_friction,
                                       T kinetic_friction, T rolling_friction) {
  const T zero(0);
  const T dn = max(slop - C, -sums.normal_sum);
  const T normal_sum = sums.normal_sum + dn;
  const auto active = normal_sum > zero;
  const RollingSums<T> before{cross(sums.tangent_sum, n), moment_sum};
  RollingSums<T> after = solve_rolling(before, response, n, slip, roll, static_friction, kinetic_friction,
                                       rolling_friction, normal_sum);
  for (int axis = 0; axis < 3; ++axis) {
    after.friction[axis] = select(active, after.friction[axis], zero);
    after.moment[axis] = select(active, after.moment[axis], zero);
  }
  const Vec3<T> tangent_sum = cross(n, after.friction);
  const RollingChange<T> change{n * dn + (tangent_sum - sums.tangent_sum), after.friction - before.friction,
                                after.moment - before.moment};
  sums = {select(active, normal_sum, zero), tangent_sum};
  moment_sum = after.moment;
  return change;
}

/// Change of velocity by a contact whose normal sum is above 0.
template <class T>
struct Restitution {
  Vec3<T> change;          ///< of the relative velocity [m/s]
  T restitution_velocity;  ///< normal part of the change [m/s]
};

/// Restitution: the normal part of the relative velocity u becomes e times the approach speed where that is
/// above `threshold`, else 0. The change never removes more velocity than the contact added. Friction is then limited
/// by the new normal sum. If several contacts support one object, each pushes more than its part, and only the sum of
/// the remaining pushes carries the weight. `approach`: of the predicted motion [m/s].
template <class T>
Restitution<T> solve_restitution(const ContactSums<T>& sums, const Vec3<T>& n, const Vec3<T>& u, T approach,
                                 T threshold, T restitution, T static_friction, T kinetic_friction,
                                 T inverse_h) {
  const T zero(0), u_n = dot(n, u), normal_sum = sums.normal_sum * inverse_h;
  const T target = select(approach > threshold, restitution * approach, zero);
  const T restitution_velocity = max(target - u_n, -normal_sum);
  const Vec3<T> friction = sums.tangent_sum * inverse_h;
  const Vec3<T> sticking = friction - (u - n * u_n);
  const Vec3<T> tangent_sum =
      within_friction(sticking, static_friction, kinetic_friction, normal_sum + restitution_velocity);
  return {n * restitution_velocity + (tangent_sum - friction), restitution_velocity};
}

/// Restitution of balls that rotate: changes of velocities, and of F and G per second [m/s].
template <class T>
struct RollingRestitution {
  RollingChange<T> change;
  T restitution_velocity;
};

template <class T>
RollingRestitution<T> solve_rolling_restitution(const ContactSums<T>& sums, const Vec3<T>& moment_sum,
                                                const Vec3<T>& n, T u_n, const Vec3<T>& slip,
                                                const Vec3<T>& roll, const RollingResponse<T>& response,
                                                T approach, T threshold, T restitution, T static_friction,
                                                T kinetic_friction, T rolling_friction, T inverse_h) {
  const T zero(0), normal_sum = sums.normal_sum * inverse_h;
  const T target = select(approach > threshold, restitution * approach, zero);
  const T restitution_velocity = max(target - u_n, -normal_sum);
  const RollingSums<T> before{cross(sums.tangent_sum, n) * inverse_h, moment_sum * inverse_h};
  const RollingSums<T> after =
      solve_rolling(before, response, n, slip, roll, static_friction, kinetic_friction, rolling_friction,
                    normal_sum + restitution_velocity);
  const Vec3<T> friction = after.friction - before.friction;
  return {{n * restitution_velocity + cross(n, friction), friction, after.moment - before.moment},
          restitution_velocity};
}

inline Restitution<float> solve_restitution(const ContactSums<float>& sums, const Vec3f& n, const Vec3f& u,
                                            float approach, float threshold,
                                            const ContactMaterialPair& material, float inverse_h) {
  return solve_restitution(sums, n, u, approach, threshold, material.restitution, material.static_friction,
                           material.kinetic_friction, inverse_h);
}

}  // namespace souple
