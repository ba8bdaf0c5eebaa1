#pragma once

#include "souple/rigid/impulse.h"
#include "souple/rigid/rigid_contact.h"

#include <array>
#include <cstdint>
#include <span>

// The points of a contact as rows of a linear complementarity problem in positional impulses (force times h^2 [kg m]).

namespace souple {

/// What contacts see and move of a body in a substep.
struct ContactBody {
  Vec3d dx{}, dtheta{};  ///< correction of the predicted pose so far [m], [rad]
  double inverse_mass = 0;
  Vec3d inertia_diagonal{}, inertia_rest{};  ///< I^-1 in world axes: (xx, yy, zz), (yz, xz, xy)

  Vec3d correction_at(const Vec3d& r) const { return dx + cross(dtheta, r); }
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

/// A point of a contact. Coordinates along the tangents of its block.
struct ContactRow {
  /// From the centers of mass when the substep began [m]: both sides' impulses act at one point, so that they keep the
  /// angular momentum of both exactly.
  Vec3d r_a{}, r_b{};
  double C = 0;                                     ///< less what may stay of an older overlap [m]
  std::array<double, 2> slip{};                     ///< less what may stay of an older one [m]
  double normal_mass = 0;                           ///< [kg]
  double tangent_00 = 0, tangent_01 = 0, tangent_11 = 0;  ///< inverse of the tangents' inverse mass [kg]
  double tangent_inverse = 0;                       ///< largest inverse mass along a tangent, bound [1/kg]
  double normal = 0;                                ///< impulse so far, not negative [kg m]
  std::array<double, 2> tangent{};                  ///< [kg m]
  std::array<double, 3> base{}, u{}, du{}, last{};
  double normal_softness = 0, tangent_softness = 0;
  double limit = 0;
};

/// A contact.
struct ContactBlock {
  Vec3d n{}, t0{}, t1{};  ///< n from b to a
  std::uint32_t a = 0, b = 0;
  std::uint32_t contact = 0;
  std::uint32_t count = 0;
  bool moves_a = false, moves_b = false;
  double static_friction = 0, kinetic_friction = 0;
  std::array<ContactRow, 4> rows{};
};

/// A contact at given poses.
struct PlacedContact {
  Vec3d n{};     ///< from b to a
  Vec3d x{};     ///< where the sides touch [m]
  double C = 0;  ///< [m]
};
PlacedContact place(const RigidContact& contact, const RigidContactPoint& point,
                    std::span<const BodyPose> poses);

inline Vec3d tangential(const Vec3d& v, const Vec3d& n) {
  return v - n * dot(n, v);
}

}  // namespace souple
