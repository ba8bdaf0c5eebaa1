#pragma once

#include "souple/constraints/constraint.h"
#include "souple/math/elementary.h"
#include "souple/solver/projector.h"

#include <cmath>

// The formulas of projection.h for one scalar C with a number of particles known at run time. In double,
// because they sum over many particles.

namespace souple {

/// Material and kind of a scalar constraint.
struct ScalarSettings {
  Sense sense = Sense::equality;
  double compliance = 0;    ///< alpha [(unit of C)^2 / J]
  double damping_time = 0;  ///< tau [s]
  double stiffness = 1;     ///< PBD mode only: k in [0, 1]
};

/// Value of C and sums over its particles: the input of a projection.
struct ScalarState {
  double C = 0;
  double weighted_square = 0;  ///< sum_i w_i |grad_i C|^2
};

/// Result of one projection.
struct ScalarStep {
  double dlambda = 0;
  double factor = 0;  ///< dx_i = factor w_i grad_i C; equals dlambda, times k' in PBD mode
};

/// dlambda = (-C - alpha~ lambda) / (sum_i w_i |grad_i C|^2 + alpha~) with alpha~ = alpha / h^2, 0 in PBD mode.
/// Without a gradient dlambda is 0.
inline ScalarStep project_scalar(const ScalarState& state, const ScalarSettings& settings, double lambda,
                                 const Substep& substep) {
  const double h = static_cast<double>(substep.h);
  const bool pbd = substep.mode == Mode::pbd;
  const double alpha = pbd ? 0 : settings.compliance / (h * h);
  if (!(state.weighted_square > 0)) return {};
  double dlambda = (-state.C - alpha * lambda) / (state.weighted_square + alpha);
  dlambda *= static_cast<double>(substep.relaxation);
  // A violated inequality pushes, never pulls: the multiplier stays >= 0.
  if (settings.sense == Sense::non_negative) dlambda = std::fmax(dlambda, -lambda);
  const double scale = pbd ? 1 - elementary::pow(1 - settings.stiffness, 1.0 / substep.iterations) : 1;
  return {dlambda, scale * dlambda};
}

/// dlambda of the damping: dv_i = dlambda w_i grad_i C. `rate` is sum_i grad_i C . v_i. Without a gradient, and
/// for a satisfied inequality, dlambda is 0.
inline double damp_scalar(const ScalarState& state, double rate, const ScalarSettings& settings,
                          const Substep& substep) {
  if (settings.sense == Sense::non_negative && state.C >= 0) return 0;
  const double h = static_cast<double>(substep.h), gamma = settings.damping_time / h;
  const double denominator = gamma * state.weighted_square + settings.compliance / (h * h);
  return state.weighted_square > 0 && denominator > 0 ? -gamma * rate / denominator : 0;
}

/// Adds dv to a velocity [m/s].
inline void add_velocity(Vec4f& velocity, const Vec3d& dv) {
  velocity.set_xyz(Vec3f(Vec3d(velocity.xyz()) + dv));
}

/// Violation of the constraint, non-negative.
inline double violation_of(const ScalarSettings& settings, double C) {
  return settings.sense == Sense::non_negative ? std::fmax(-C, 0.0) : std::fabs(C);
}

/// Adds one C to a residual.
inline void add_to_residual(Residual& residual, const ScalarSettings& settings, double C) {
  const double violation = violation_of(settings, C);
  residual.largest = std::fmax(residual.largest, violation);
  residual.sum += violation;
  if (settings.compliance > 0)
    residual.energy += violation * violation / (2 * static_cast<double>(settings.compliance));
  ++residual.count;
}

}  // namespace souple
