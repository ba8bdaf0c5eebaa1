#pragma once

#include "souple/math/quaternion.h"

#include <limits>
#include <optional>

// Parts of which descriptions of joints consist.

namespace souple::joint {

inline constexpr double unlimited = std::numeric_limits<double>::infinity();

/// Where a joint is fastened to a body: a point and axes in the body's local frame, or in the world's.
struct Frame {
  Vec3d point{};     ///< m
  Quatd rotation{};  ///< the joint's axes in those of the body
};

/// Stops of one degree of freedom [m] or [rad]. A stop with compliance or damping is a spring that acts beyond it.
struct Limits {
  double low = -unlimited, high = unlimited;
  double compliance = 0;  ///< m/N or rad/(N m)
  double damping = 0;     ///< N s/m or N m s/rad
};

/// Force (rest - x) / compliance - damping dx/dt of one degree of freedom.
struct Spring {
  double rest = 0;        ///< m or rad
  double compliance = 0;  ///< m/N or rad/(N m); 0: rigid, `unlimited`: a damper alone
  double damping = 0;     ///< N s/m or N m s/rad
};

/// Drives one degree of freedom by at most `max_force`.
struct Motor {
  enum class Target { velocity, position };
  Target kind = Target::velocity;
  double target = 0;             ///< m/s or rad/s; m or rad
  double max_force = unlimited;  ///< N or N m
  double compliance = 0;         ///< of a target position [m/N] or [rad/(N m)]
  double damping = 0;            ///< of a target position [N s/m] or [N m s/rad]
};

/// Forces along one degree of freedom.
struct Axis {
  Limits limits{};
  std::optional<Spring> spring{};
  std::optional<Motor> motor{};

  bool is_free() const { return limits.low == -unlimited && limits.high == unlimited && !spring && !motor; }
};

/// Pulls the axes of b to `target` relative to those of a, by at most `max_torque` about each axis.
struct RotationSpring {
  Quatd target{};
  double compliance = 0;          ///< rad/(N m)
  double damping = 0;             ///< N m s/rad
  double max_torque = unlimited;  ///< N m
};

}  // namespace souple::joint
