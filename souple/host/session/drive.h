#pragma once

#include "souple/host/placement.h"
#include "souple/math/transform.h"

#include <string>

namespace souple::host {

/// Leads an obstacle after the host's mesh: in the course of the step that follows a move, so that it sweeps
/// and pushes what is in its way instead of appearing elsewhere.
struct Drive {
  Transform from{}, to{};      ///< reached, and wanted: of the mesh as it was added, about the world's origin
  double begin = 0, span = 0;  ///< of the step that runs [s]; span 0: it stands at `from`

  Transform at(double time) const;
  void begin_step(double time, double dt);
  /// A step that was not made leaves it at `from`.
  void end_step(bool made);
};

/// What leads a mesh from one placement to another. Throws Error, beginning with `name`, unless that is a
/// rotation and a translation.
Transform rigid_motion(const Placement& from, const Placement& to, const std::string& name);

}  // namespace souple::host
