#pragma once

#include "souple/contacts/contact.h"
#include "souple/math/vec3.h"
#include "souple/math/vec4.h"

#include <array>
#include <cstdint>
#include <vector>

namespace souple {

/// A soft body at an impact, see body_restitution.h.
struct BodyAtImpact {
  std::uint32_t object = 0;
  double mass = 0;   ///< 0: does not move as a whole [kg]
  Vec3d velocity{};  ///< of the center of mass [m/s]
  Vec3d change{};    ///< by the impacts so far [m/s]
};

/// Sums over particles relative to a point near them: mass, m x, m v, m x x^T (lower triangle), m x cross v.
struct RigidSums {
  double mass = 0;
  Vec3d position, momentum;
  std::array<double, 6> second{};
  Vec3d angular;
};

/// Data of stages, kept so that a step allocates nothing.
struct StepScratch {
  std::vector<Vec4f> predicted;       ///< p* of the explicit and implicit integrators
  std::vector<Vec4f> force;           ///< per particle: wind force [N]
  std::vector<Vec4f> triangle_force;  ///< per triangle of the current object: a third of the wind force [N]
  std::vector<RigidSums> rigid_sums;  ///< per chunk of the object being damped
  std::vector<Impact> impacts;        ///< of the substep, see body_restitution.h
  std::vector<BodyAtImpact> bodies_at_impact;
};

}  // namespace souple
