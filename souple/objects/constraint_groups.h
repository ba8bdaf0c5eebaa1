#pragma once

#include "souple/solver/enclosed_volume.h"
#include "souple/solver/shape_matching.h"

namespace souple {

/// Constraints on whole objects, solved after the sets.
struct ConstraintGroups {
  ShapeMatching shape_matching;
  EnclosedVolume enclosed_volume;
};

}  // namespace souple
