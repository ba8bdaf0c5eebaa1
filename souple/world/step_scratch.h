#pragma once

#include "souple/stages/body_restitution.h"
#include "souple/stages/damping.h"
#include "souple/stages/motion.h"

#include <vector>

namespace souple {

/// Data of stages, kept so that a step allocates nothing.
struct StepScratch {
  MotionScratch motion;
  std::vector<RigidSums> rigid_sums;
  BodyImpacts impacts;
};

}  // namespace souple
