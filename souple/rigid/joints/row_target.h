#pragma once

#include "souple/rigid/joints/rows.h"

namespace souple::joint {

/// The values of a row when the substep began, and one substep before.
struct RowHistory {
  double start = 0, before = 0;
};

/// Equation of a row for the solve: value - goal + alpha lambda = 0.
struct RowTarget {
  double goal = 0;   ///< m or rad
  double alpha = 0;  ///< 1/kg or 1/(kg m^2)
};

/// The equation of a row for a substep of `h`. `at`: as JointState::at. `K`: change of the value per impulse. `size`: of
/// the bodies, in the row's unit.
///
/// A spring's force is k (a x1 + b x0 + c x-) with the values at the substep's end, its start, and one substep before. a
/// = b = c - 0.75 = 1/12 (Numerov) follows a swing of omega h < 1 to its fourth order without loss of energy. Springs
/// that are too stiff for substeps to follow get weights that lose energy at any stiffness. A damper's force is taken
/// between the middle of the last substep (exact to the second order) and the end of this one (stable).
RowTarget target_of(const RowLaw& law, int at, const RowHistory& history, double K, double size, double h);

}  // namespace souple::joint
