#pragma once

#include "souple/stages/balance.h"
#include "souple/stages/body_restitution.h"
#include "souple/stages/damping.h"
#include "souple/stages/motion.h"
#include "souple/stages/sleeping.h"

#include <vector>

namespace souple {

/// What stages keep from substep to substep, so that a step allocates nothing.
struct StepScratch {
  MotionScratch motion;
  std::vector<RigidSums> rigid_sums;
  BodyImpacts impacts;
  Balance balance;
  SleepScratch sleep;
};

}  // namespace souple
