#pragma once

#include "souple/stages/motion.h"
#include "souple/stages/settings.h"

namespace souple {

/// Null: semi-implicit Euler. docs/integrators.md compares the integrators.
Integrate integrate_by(Integrator integrator);

}  // namespace souple
