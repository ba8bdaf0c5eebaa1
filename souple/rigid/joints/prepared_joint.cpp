#include "souple/rigid/joints/prepared_joint.h"

#include <algorithm>

namespace souple::joint {
namespace {

/// Weights of the arms at the end and a substep before, for bodies whose turning is stiff (tree_elimination.h).
constexpr double end_weight = 0.32, before_weight = 0.23;
/// Stiffness s beyond which arms are means of three, gradually.
constexpr double stiff = 1;
/// s is limited to this value: contradictory joints may have any impulse.
constexpr double stiffest = 1e5;
/// Cosine of the angle that a body turns per substep, beyond which gradients are those of the predicted poses.
constexpr double far = 0.88;

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

/// The equation of a row for a substep of `h`. `at`: as JointState::at. `K`: change of the value per impulse. `size`: of
/// the bodies, in the row's unit.
///
/// A spring's force is k (a x1 + b x0 + c x-) with the values at the substep's end, its start, and one substep before. a
/// = b = c - 0.75 = 1/12 (Numerov) follows a swing of omega h < 1 to its fourth order without loss of energy. Springs
/// that are too stiff for substeps to follow get weights that lose energy at any stiffness. A damper's force is taken
/// between the middle of the last substep (exact to the second order) and the end of this one (stable).
RowTarget target_of(const RowLaw& law, int at, const RowHistory& history, double K, double size, double h) {
  if (law.kind == RowLaw::Kind::speed) return {history.start + law.low * h, motor * K};
  const double rest = law.kind == RowLaw::Kind::range && at > 0 ? law.high : law.low;
  if (!std::isfinite(rest)) return {history.start, 1};  // a range without this end: never solved
  if (law.compliance > 0) return soft_target(law, rest, history, K, h);
  return rigid_target(law, rest, history, K, size, h);
}

BodyPose pose_of(std::span<const BodyPose> poses, std::uint32_t body) {
  return body == no_body ? BodyPose{} : poses[body];
}

double cosine_between(const Quatd& p, const Quatd& q) {
  const double half = std::abs(p.x * q.x + p.y * q.y + p.z * q.z + p.w * q.w);
  return 2 * half * half - 1;
}

double largest(const Vec3d& v) {
  return std::max({v.x, v.y, v.z});
}

/// Largest inverse inertia about an axis perpendicular to r. It is the larger eigenvalue of the part of I^-1 across r,
/// whose trace is t and whose determinant is d.
double inverse_inertia_across(const RigidBodies& bodies, std::uint32_t body, const Vec3d& r) {
  if (!is_movable(bodies, body)) return 0;
  const Vec3d n = normalized(r);
  const Mat3d& inverse = bodies.inverse_inertia[body];
  const double t = trace(inverse) - dot(n, inverse * n), d = dot(n, cofactor(inverse) * n);
  return (t + std::sqrt(std::max(0.0, t * t - 4 * d))) / 2;
}

double gyration_radius(const RigidBodies& bodies, std::uint32_t body) {
  if (body == no_body) return 0;
  const double I = largest(bodies.mass[body].inverse_inertia);
  return I > 0 ? std::sqrt(bodies.mass[body].inverse / I) : 0;
}

double inverse_mass_of(const RigidBodies& bodies, std::uint32_t body, const Vec3d& linear,
                       const Vec3d& angular) {
  if (body == no_body) return 0;
  return bodies.mass[body].inverse * dot(linear, linear) +
         dot(angular, bodies.inverse_inertia[body] * angular);
}

bool is_zero(const Row& row) {
  return length_squared(row.linear_a) + length_squared(row.angular_a) + length_squared(row.linear_b) +
             length_squared(row.angular_b) ==
         0;
}

/// Positional impulse of the rows that hold the points together [kg m].
Vec3d point_impulse(const JointState& state) {
  return {state.lambda[0], state.lambda[1], state.lambda[2]};
}

Arm arm_of(const BodyPose& start, const BodyPose& predicted, const Vec3d& local) {
  const Vec3d r = start.direction(local);
  return {rotate(start.rotation * conjugate(predicted.rotation), r), r, predicted.direction(local)};
}

Vec3d mean_of(const Arm& arm, double end, double before) {
  return arm.start + (arm.predicted - arm.start) * end + (arm.before - arm.start) * before;
}

void set_arms(Rows& rows, const Vec3d& ra, const Vec3d& rb) {
  const Mat3d e = Mat3d::identity();
  for (std::size_t k = 0; k < 3; ++k) {
    rows.row[k].angular_a = -cross(ra, e.column[k]);
    rows.row[k].angular_b = cross(rb, e.column[k]);
  }
}

/// Scales the impulses of the last substep to this one.
void warm_start(JointState& state, const Rows& start, const Rows& predicted, double h,
                PreparedJoint& prepared) {
  const double ratio = state.h > 0 ? h / state.h : 0;
  for (std::size_t i = 0; i < prepared.count(); ++i) {
    const double now = start.row[i].value;
    const double motion = state.h > 0 ? (now - state.value[i]) * ratio : predicted.row[i].value - now;
    prepared.history[i] = {now, now - motion};
    state.value[i] = now;
    state.lambda[i] *= ratio * ratio;
  }
  state.h = h;
}

void update_angles(const Joint& joint, const Ends& ends, JointState& state) {
  if (std::holds_alternative<Hinge>(joint.kind)) state.angle[0] = hinge_angle(ends);
  if (std::holds_alternative<Universal>(joint.kind)) state.angle = universal_angles(ends);
}

/// Length or angle with which errors of a row are compared [m] or [rad].
double size_of(std::size_t i, const PreparedJoint& prepared) {
  return length_squared(prepared.rows.row[i].linear_b) > 0 ? prepared.size : 1;
}

void find_target(const RowLaw& law, int at, double h, std::size_t i, PreparedJoint& prepared) {
  prepared.target[i] = target_of(law, at, prepared.history[i], prepared.K[i], size_of(i, prepared), h);
}

/// The end of its range, or of its force, at which a row is.
int end_of(const RowLaw& law, int at, double value, double lambda, const RowTarget& target, double most) {
  if (law.kind == RowLaw::Kind::range) {
    if (at != 0) return at * lambda > 0 ? 0 : at;  // a row at its low end pushes up, never pulls
    return value < law.low ? -1 : (value > law.high ? 1 : 0);
  }
  if (at == 0) return lambda > most ? 1 : (lambda < -most ? -1 : 0);
  const double left = value - target.goal + target.alpha * lambda;
  return at * left > 0 ? 0 : at;
}

}  // namespace

bool is_movable(const RigidBodies& bodies, std::uint32_t body) {
  return body != no_body && (bodies.mass[body].inverse > 0 || largest(bodies.mass[body].inverse_inertia) > 0);
}

void prepare(const Joint& joint, JointState& state, const RigidBodies& bodies, double h,
             PreparedJoint& prepared) {
  prepared.active = !state.broken && (is_movable(bodies, joint.a) || is_movable(bodies, joint.b));
  if (!prepared.active) {
    prepared.rows = rows_of(joint, ends_of(joint, state, bodies));
    prepared.solved = {}, prepared.change = {};
    return;
  }
  const BodyPose start_a = pose_of(bodies.start, joint.a), start_b = pose_of(bodies.start, joint.b);
  const BodyPose pose_a = pose_of(bodies.pose, joint.a), pose_b = pose_of(bodies.pose, joint.b);
  const Ends ends = ends_of(joint, start_a, start_b, state.angle);
  update_angles(joint, ends, state);
  const Rows start = rows_of(joint, ends),
             predicted = rows_of(joint, ends_of(joint, pose_a, pose_b, state.angle));
  const bool turns_far = cosine_between(start_a.rotation, pose_a.rotation) < far ||
                         cosine_between(start_b.rotation, pose_b.rotation) < far;
  prepared.rows = turns_far ? predicted : start;
  for (std::size_t i = 0; i < prepared.count(); ++i)
    if (is_zero(start.row[i])) prepared.rows.row[i] = predicted.row[i];
  warm_start(state, start, predicted, h, prepared);

  prepared.arm_a = arm_of(start_a, pose_a, joint.frame_a.point);
  prepared.arm_b = arm_of(start_b, pose_b, joint.frame_b.point);
  prepared.inertia_a = inverse_inertia_across(bodies, joint.a, prepared.arm_a.predicted);
  prepared.inertia_b = inverse_inertia_across(bodies, joint.b, prepared.arm_b.predicted);
  prepared.has_arms = prepared.rows.has_point && !turns_far;
  prepared.stiffness = prepared.turning = 0;
  prepared.size = gyration_radius(bodies, joint.a) + gyration_radius(bodies, joint.b);
  if (joint.a != no_body) prepared.size += length(prepared.arm_a.start);
  if (joint.b != no_body) prepared.size += length(prepared.arm_b.start);
  for (std::size_t i = 0; i < prepared.count(); ++i) {
    const Row& row = prepared.rows.row[i];
    prepared.K[i] = inverse_mass_of(bodies, joint.a, row.linear_a, row.angular_a) +
                    inverse_mass_of(bodies, joint.b, row.linear_b, row.angular_b);
    find_target(prepared.rows.law[i], state.at[i], h, i, prepared);
  }
}

double stiffness_of(const JointState& state, const PreparedJoint& prepared) {
  if (!prepared.active || !prepared.has_arms) return 0;
  const Vec3d p = point_impulse(state);
  return std::min(std::max({0.0, -dot(prepared.arm_a.start, p) * prepared.inertia_a,
                            dot(prepared.arm_b.start, p) * prepared.inertia_b}),
                  stiffest);
}

void weigh_arms(const Joint& joint, const JointState& state, bool jerk, PreparedJoint& prepared,
                std::span<Mat3d> stiffness) {
  prepared.stiffness = stiffness_of(state, prepared);
  if (!prepared.active || !prepared.has_arms) return;
  const double s = prepared.stiffness / stiff, weight = s * s / (1 + s * s);
  prepared.turning = (jerk ? 1 : end_weight) * weight;
  const double before = jerk ? 0 : before_weight * weight;
  set_arms(prepared.rows, mean_of(prepared.arm_a, prepared.turning, before),
           mean_of(prepared.arm_b, prepared.turning, before));
  const auto add = [&](std::uint32_t body, const Vec3d& r, double inverse_inertia, const Vec3d& impulse) {
    const double pull = dot(r, impulse);
    if (!(inverse_inertia > 0) || !(pull > 0)) return;
    const double k = prepared.turning * std::min(pull, stiffest / inverse_inertia);
    stiffness[body] = stiffness[body] + Mat3d::diagonal({k, k, k}) - outer(r, r) * (k / dot(r, r));
  };
  const Vec3d p = point_impulse(state);
  add(joint.a, prepared.arm_a.start, prepared.inertia_a, -p);
  add(joint.b, prepared.arm_b.start, prepared.inertia_b, p);
}

Refreshed refresh(const Joint& joint, JointState& state, const RigidBodies& bodies, double h,
                  Gradients gradients, PreparedJoint& prepared) {
  Refreshed result;
  if (!prepared.active) return result;
  const Rows now = rows_of(joint, ends_of(joint, state, bodies));
  for (std::size_t i = 0; i < prepared.count(); ++i) {
    const RowLaw& law = prepared.rows.law[i];
    const double value = prepared.rows.row[i].value = now.row[i].value;
    if (gradients == Gradients::present && !is_zero(now.row[i])) prepared.rows.row[i] = now.row[i];
    const double most = law.max_force * h * h;
    const int at = end_of(law, state.at[i], value, state.lambda[i], prepared.target[i], most);
    if (at != state.at[i] && law.kind == RowLaw::Kind::range) find_target(law, at, h, i, prepared);
    state.at[i] = static_cast<std::int8_t>(at);
    const bool is_range = law.kind == RowLaw::Kind::range;
    const bool solved = prepared.K[i] > 0 && (is_range == (at != 0));
    result.changed |= solved != prepared.solved[i];
    prepared.solved[i] = solved;
    const double known = is_range || at == 0 ? 0 : at * most;
    prepared.change[i] = solved ? 0 : known - state.lambda[i];
    const RowTarget& target = prepared.target[i];
    // A soft row counts as far as impulses change its value: K / (K + alpha).
    const double left = std::abs(value - target.goal + target.alpha * state.lambda[i]) * prepared.K[i] /
                        (prepared.K[i] + target.alpha);
    if (solved) result.error = std::max(result.error, left / size_of(i, prepared));
  }
  return result;
}

void report(const Joint& joint, JointState& state, const PreparedJoint& prepared) {
  state.force = state.torque = {};
  if (!prepared.active || !(state.h > 0)) return;  // or its kind was changed within the substep
  Vec3d force_a;
  for (std::size_t i = 0; i < prepared.count(); ++i) {
    const Row& row = prepared.rows.row[i];
    const double f = state.lambda[i] / (state.h * state.h);
    if (length_squared(row.linear_b) > 0) {
      state.force += row.linear_b * f, force_a += row.linear_a * f;
    } else {
      state.torque += row.angular_b * f;
    }
  }
  const double force = std::max(length(state.force), length(force_a));
  state.broken = force > joint.breaking_force || length(state.torque) > joint.breaking_torque;
}

}  // namespace souple::joint
