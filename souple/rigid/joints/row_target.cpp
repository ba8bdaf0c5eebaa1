#include "souple/rigid/joints/row_target.h"

#include <algorithm>

namespace souple::joint {
namespace {

/// Compliance of rigid rows relative to K: keeps systems with redundant joints solvable.
constexpr double rigid = 1e-8;
/// The relative compliance of motors: limits and axes take precedence.
constexpr double motor = 1e-6;
/// A rigid row removes errors below this part of the bodies' size at once. Joints that were assembled wrongly close at
/// `closing` times their error per second, so that nothing is thrown away.
constexpr double at_once = 1e-3, closing = 20;

/// Part of the error that a rigid row leaves for later substeps.
double left_for_later(double error, double size, double h) {
  const double beyond = std::max(0.0, std::abs(error) - at_once * size);
  return std::copysign(beyond * std::max(0.0, 1 - closing * h), error);
}

RowTarget rigid_target(const RowLaw& law, double rest, const RowHistory& history, double K, double size,
                       double h) {
  double error = history.start - rest;
  if (law.kind == RowLaw::Kind::range) error = rest == law.high ? std::max(0.0, error) : std::min(0.0, error);
  if (!law.servo) return {rest + left_for_later(error, size, h), rigid * K};
  if (law.max_force == unlimited) return {rest + left_for_later(error, size, h), motor * K};
  // The speed from which 0.8 of the force stops the bodies at the target.
  const double step = std::sqrt(1.6 * law.max_force * K * std::abs(error)) * h;
  return {history.start - std::clamp(error, -step, step), motor * K};
}

RowTarget soft_target(const RowLaw& law, double rest, const RowHistory& history, double K, double h) {
  const double k = law.compliance < unlimited ? h * h / law.compliance : 0, d = h * law.damping;
  const double s = k * K, t = s * s / (1 + s * s), z = d * K;
  const double a = 1.0 / 12 + (0.32 - 1.0 / 12) * t, c = 1.0 / 12 + (0.23 - 1.0 / 12) * t, b = 1 - a - c;
  const double end = (1 + z) / (2 + z);
  const double x0 = history.start - rest, x = history.before - rest;
  const double stiffness = k * a + d * end;
  const double others = k * (b * x0 + c * x) - d * end * x0 + d * (1 - end) * (x0 - x);
  return {rest - others / stiffness, 1 / stiffness + rigid * K};
}

}  // namespace

RowTarget target_of(const RowLaw& law, int at, const RowHistory& history, double K, double size, double h) {
  if (law.kind == RowLaw::Kind::speed) return {history.start + law.low * h, motor * K};
  const double rest = law.kind == RowLaw::Kind::range && at > 0 ? law.high : law.low;
  if (!std::isfinite(rest)) return {history.start, 1};  // a range without this end: never solved
  if (law.compliance > 0) return soft_target(law, rest, history, K, h);
  return rigid_target(law, rest, history, K, size, h);
}

}  // namespace souple::joint
