#pragma once

#include "souple/solver/sweep_regions.h"
#include "souple/stages/angular_momentum.h"
#include "souple/stages/balance.h"
#include "souple/stages/body_restitution.h"
#include "souple/stages/damping.h"
#include "souple/stages/motion.h"

#include <memory>
#include <vector>

namespace souple {

struct SleepScratch;

/// Data that stages keep from substep to substep, so that a step allocates nothing.
struct StepScratch {
  StepScratch();
  ~StepScratch();

  MotionScratch motion;
  std::vector<RigidSums> rigid_sums;
  BodyImpacts impacts;
  Balance balance;
  AngularMomentum angular_momentum;
  AngularMomentum::Links links;
  std::vector<IndexRange> without_levels;
  SweepRegions regions;
  std::unique_ptr<SleepScratch> sleep;
};

}  // namespace souple
