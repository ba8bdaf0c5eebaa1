#pragma once

#include "souple/host/placement.h"
#include "souple/math/transform.h"

#include <string>

namespace souple::host {

/// Moves an obstacle to its mesh's transform in the host, continuously during the next step. It thereby
/// sweeps its path and pushes the objects there, instead of jumping.
struct Drive {
  /// Reached and requested motion relative to the mesh at its addition, about the world's origin.
  Transform from{}, to{};
  double begin = 0, span = 0;  ///< start and length of the current step [s]; span 0: no motion

  Transform at(double time) const;
  void begin_step(double time, double dt);
  /// A failed step (`made` false) leaves the obstacle at `from`.
  void end_step(bool made);
};

/// The motion from one placement to another. Throws Error, beginning with `name`, unless it is a rotation and
/// a translation.
Transform rigid_motion(const Placement& from, const Placement& to, const std::string& name);

}  // namespace souple::host
