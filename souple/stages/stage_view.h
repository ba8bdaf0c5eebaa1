#pragma once

#include "souple/objects/objects_view.h"
#include "souple/stages/settings.h"
#include "souple/state/warnings.h"
#include "souple/threads/threads.h"

namespace souple {

/// State that the stages of a substep read and change.
struct StageView {
  ObjectsView objects;
  const Settings& settings;
  Threads& threads;
  Warnings& warnings;
  double time;  ///< at the start of the substep [s]
};

}  // namespace souple
