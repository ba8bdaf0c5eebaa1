#pragma once

#include "souple/rigid/impulse.h"
#include "souple/rigid/rigid_contact.h"

#include <array>
#include <cmath>
#include <cstdint>
#include <span>

// The points of a contact as rows of a complementarity problem in positional impulses, forces times h^2 [kg m].

namespace souple {

/// A body as contacts see and move it in a substep.
struct ContactBody {
  Vec3d dx{}, dtheta{};  ///< motion by contact impulses in this substep [m], [rad]
  double inverse_mass = 0;
  Vec3d inertia_diagonal{}, inertia_rest{};  ///< I^-1 in world axes: (xx, yy, zz), (yz, xz, xy)

  Vec3d motion_at(const Vec3d& r) const { return dx + cross(dtheta, r); }
  Vec3d spin_of(const Vec3d& L) const {
    const Vec3d &d = inertia_diagonal, &o = inertia_rest;
    return {d.x * L.x + o.z * L.y + o.y * L.z, o.z * L.x + d.y * L.y + o.x * L.z,
            o.y * L.x + o.x * L.y + d.z * L.z};
  }
  void push(const Vec3d& r, const Vec3d& impulse) {
    dx += impulse * inverse_mass;
    dtheta += spin_of(cross(r, impulse));
  }
};

/// Components along the normal of a contact and its two tangents.
using ContactVector = std::array<double, 3>;

/// A point of a contact. With u = J q, the motion of a against b by impulses, a row asks for
///   C + u_n + softness_n p_n >= 0,  p_n >= 0,  one of both 0;   slip + u_t + softness_t p_t = 0,  |p_t| <= mu p_n.
/// So a contact is a spring: C and p_n are totals of the substep, not changes. If C raised multipliers in each substep,
/// they would integrate gaps, and a stack would begin to sway.
struct ContactRow {
  /// Arms from the centers of mass at the start of the substep [m]. The impulses on both sides act at one point, which
  /// conserves angular momentum exactly.
  Vec3d r_a{}, r_b{};
  ContactVector gap{};      ///< C and slip without contact impulses [m]
  ContactVector ignored{};  ///< part of an older overlap and slip that stays, added to both [m]
  ContactVector impulse{};  ///< p [kg m]
  double normal_softness = 0, tangent_softness = 0;  ///< [1/kg]
  double normal_mass = 0;                            ///< 1 / (J M^-1 J^T + softness) [kg]
  double mass_00 = 0, mass_01 = 0, mass_11 = 0;      ///< likewise of the tangents
  double sliding_mass = 0;                           ///< least mass along a tangential direction [kg]
};

/// A contact.
struct ContactBlock {
  std::array<Vec3d, 3> axes{};  ///< normal from b to a, two tangents
  std::uint32_t a = 0, b = 0;   ///< in the list of ContactBody
  std::uint32_t contact = 0;    ///< in the list of contacts
  std::uint32_t count = 0;      ///< of rows
  bool moves_a = false, moves_b = false;
  double static_friction = 0, kinetic_friction = 0;
  std::array<ContactRow, 4> rows{};

  Vec3d in_world(const ContactVector& v) const { return axes[0] * v[0] + axes[1] * v[1] + axes[2] * v[2]; }
  ContactVector along_axes(const Vec3d& v) const {
    return {dot(axes[0], v), dot(axes[1], v), dot(axes[2], v)};
  }
  /// Cuts an impulse to the contact's limits: no pull, and friction at most mu times the push.
  ContactVector within_limits(const ContactVector& p) const {
    const double normal = max(p[0], 0.0), limit = static_friction * normal;
    const double square = p[1] * p[1] + p[2] * p[2];
    if (square <= limit * limit) return {normal, p[1], p[2]};
    const double scale = kinetic_friction * normal / std::sqrt(square);
    return {normal, p[1] * scale, p[2] * scale};
  }
  /// Whether friction holds, that is the impulse is not at its limit.
  bool sticks(const ContactRow& row) const {
    constexpr double rounding = 1e-9;
    const double limit = kinetic_friction * row.impulse[0], square = limit * limit;
    const double size = row.impulse[1] * row.impulse[1] + row.impulse[2] * row.impulse[2];
    return std::abs(size - square) > rounding * square;
  }
  /// Moves both sides by an impulse on a.
  void push(std::span<ContactBody> bodies, const ContactRow& row, const Vec3d& impulse) const {
    if (moves_a) bodies[a].push(row.r_a, impulse);
    if (moves_b) bodies[b].push(row.r_b, -impulse);
  }
  /// C and slip, each with softness times impulse: 0 if the row holds [m].
  ContactVector residual(std::span<const ContactBody> bodies, const ContactRow& row) const {
    const ContactVector u = along_axes(bodies[a].motion_at(row.r_a) - bodies[b].motion_at(row.r_b));
    return {row.gap[0] + u[0] + row.normal_softness * row.impulse[0],
            row.gap[1] + u[1] + row.tangent_softness * row.impulse[1],
            row.gap[2] + u[2] + row.tangent_softness * row.impulse[2]};
  }
};

/// A point of a contact at given poses.
struct PlacedContact {
  Vec3d n{};     ///< from b to a
  Vec3d x{};     ///< where the sides touch [m]
  double C = 0;  ///< [m]
};
PlacedContact place(const RigidContact& contact, const RigidContactPoint& point,
                    std::span<const BodyPose> poses);

/// Removal of overlaps of earlier substeps.
struct Depenetration {
  double part = 0;     ///< of an overlap, removed in a substep
  double largest = 0;  ///< largest removal in a substep [m]
};

/// Rows at the start of a substep, with the impulses of the last one. `states`: per body, and one that does not move.
void start_block(RigidContact& contact, ContactBlock& block, const RigidBodies& bodies,
                 std::span<const ContactBody> states, const Depenetration& depenetration);
/// Measures the gaps at the current poses.
void measure_block(const RigidContact& contact, ContactBlock& block, const RigidBodies& bodies,
                   std::span<const ContactBody> states);
/// One pass over the points of a contact. Returns the largest change of a relative position [m].
double sweep_block(ContactBlock& block, std::span<ContactBody> states);
/// Keeps the impulses for the next substep.
void keep_block(const ContactBlock& block, RigidContact& contact);

inline Vec3d tangential(const Vec3d& v, const Vec3d& n) {
  return v - n * dot(n, v);
}

}  // namespace souple
