#include "souple/rigid/joints/joint.h"

#include <algorithm>

namespace souple::joint {
namespace {

BodyPose pose_of(const RigidBodies& bodies, std::uint32_t body) {
  return body == no_body ? BodyPose{} : bodies.pose[body];
}

/// Distance of a value from the range of a rigid law.
double violation(const RowLaw& law, double value) {
  if (law.compliance > 0 || law.max_force < unlimited || law.kind == RowLaw::Kind::speed) return 0;
  const double high = law.kind == RowLaw::Kind::range ? law.high : law.low;
  return std::max({0.0, law.low - value, value - high});
}

std::array<double, 2> coordinates(const Fixed& /*kind*/, const Ends& /*ends*/) {
  return {};
}
std::array<double, 2> coordinates(const Ball& /*kind*/, const Ends& ends) {
  return {swing_row(ends).value, twist_row(ends).value};
}
std::array<double, 2> coordinates(const Hinge& /*kind*/, const Ends& ends) {
  return {hinge_angle(ends), 0};
}
std::array<double, 2> coordinates(const Slider& /*kind*/, const Ends& ends) {
  return {row_across(ends, ends.axes_a.column[0]).value, 0};
}
std::array<double, 2> coordinates(const Universal& /*kind*/, const Ends& ends) {
  return universal_angles(ends);
}
std::array<double, 2> coordinates(const Distance& /*kind*/, const Ends& ends) {
  return {distance_row(ends).value, 0};
}
std::array<double, 2> coordinates(const Pulley& kind, const Ends& ends) {
  return {rope_row(kind, ends).value, 0};
}

}  // namespace

std::string_view kind_name(const Kind& kind) {
  constexpr std::array<std::string_view, 7> names{"fixed",     "ball",     "hinge", "slider",
                                                  "universal", "distance", "pulley"};
  static_assert(names.size() == std::variant_size_v<Kind::variant>);
  return names[kind.index()];
}

std::array<double, 2> coordinates_of(const Joint& joint, const Ends& ends) {
  return std::visit([&](const auto& kind) { return coordinates(kind, ends); }, joint.kind);
}

std::uint32_t add(Joints& joints, Joint joint, std::size_t body_count) {
  validate(joint, body_count);
  for (Frame* frame : {&joint.frame_a, &joint.frame_b}) frame->rotation = normalized(frame->rotation);
  joints.joint.push_back(std::move(joint));
  joints.state.emplace_back();
  return static_cast<std::uint32_t>(joints.size() - 1);
}

void place(Joint& joint, const RigidBodies& bodies, const Vec3d& point, const Quatd& axes) {
  const auto frame_in = [&](std::uint32_t body) {
    const BodyPose pose = pose_of(bodies, body);
    return Frame{pose.local_point(point), conjugate(pose.rotation) * axes};
  };
  joint.frame_a = frame_in(joint.a), joint.frame_b = frame_in(joint.b);
}

Quatd axes_along(const Vec3d& axis) {
  const Vec3d x{1, 0, 0}, n = normalized(axis);
  if (!(length_squared(n) > 0)) return {0, 0, 0, 0};
  if (n.x < -1 + 1e-12) return {0, 0, 1, 0};
  const Vec3d c = cross(x, n);
  return normalized(Quatd{c.x, c.y, c.z, 1 + n.x});
}

Ends ends_of(const Joint& joint, const BodyPose& a, const BodyPose& b, const std::array<double, 2>& angle) {
  return {a.position,
          b.position,
          a.point(joint.frame_a.point),
          b.point(joint.frame_b.point),
          rotation_matrix(a.rotation * joint.frame_a.rotation),
          rotation_matrix(b.rotation * joint.frame_b.rotation),
          angle};
}

Ends ends_of(const Joint& joint, const JointState& state, const RigidBodies& bodies) {
  return ends_of(joint, pose_of(bodies, joint.a), pose_of(bodies, joint.b), state.angle);
}

Rows rows_of(const Joint& joint, const Ends& ends) {
  Rows rows;
  std::visit([&](const auto& kind) { add_rows(kind, ends, rows); }, joint.kind);
  return rows;
}

JointError error_of(const Joint& joint, const JointState& state, const RigidBodies& bodies) {
  return state.broken ? JointError{} : error_of(joint, ends_of(joint, state, bodies));
}

JointError error_of(const Joint& joint, const Ends& ends) {
  JointError error;
  const Rows rows = rows_of(joint, ends);
  for (std::size_t i = 0; i < static_cast<std::size_t>(rows.count); ++i) {
    const Row& row = rows.row[i];
    const bool linear = length_squared(row.linear_a) + length_squared(row.linear_b) > 0;
    double& worst = linear ? error.distance : error.angle;
    worst = std::max(worst, violation(rows.law[i], row.value));
  }
  return error;
}

}  // namespace souple::joint
