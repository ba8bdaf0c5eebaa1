#include "souple/scene/build_joints.h"

#include "souple/math/limits.h"
#include "souple/objects/joint_options.h"
#include "souple/objects/tie_options.h"
#include "souple/rigid/joints/joint.h"
#include "souple/world/world.h"

#include <algorithm>

namespace souple {
namespace {

constexpr double degree = pi / 180;  // rad

joint::Limits limits_of(const JointLimitsDescription& limits, double unit) {
  return {limits.low ? *limits.low * unit : -joint::unlimited,
          limits.high ? *limits.high * unit : joint::unlimited, limits.compliance, limits.damping};
}

joint::Motor motor_of(const JointMotorDescription& motor, double unit) {
  const bool to_velocity = motor.velocity.has_value();
  return {to_velocity ? joint::Motor::Target::velocity : joint::Motor::Target::position,
          to_velocity ? *motor.velocity : motor.position.value_or(0) * unit,
          motor.max_force.value_or(joint::unlimited), motor.compliance, motor.damping};
}

/// `unit`: radians or meters per unit of the file.
joint::Axis axis_of(const JointAxisDescription& axis, double unit) {
  joint::Axis result;
  if (axis.limits) result.limits = limits_of(*axis.limits, unit);
  if (axis.spring)
    result.spring = {axis.spring->rest * unit, axis.spring->compliance.value_or(joint::unlimited),
                     axis.spring->damping};
  if (axis.motor) result.motor = motor_of(*axis.motor, unit);
  return result;
}

joint::Kind kind_of(const FixedJointDescription& j) {
  return joint::Fixed{j.compliance, j.damping, j.angular_compliance, j.angular_damping};
}

joint::Kind kind_of(const BallJointDescription& j) {
  joint::Ball ball{.compliance = j.compliance, .damping = j.damping, .swing_compliance = j.swing_compliance};
  if (j.max_swing) ball.max_swing = *j.max_swing * degree;
  if (j.twist) ball.twist = limits_of(*j.twist, degree);
  if (j.spring)
    ball.spring = {
        {}, j.spring->compliance, j.spring->damping, j.spring->max_torque.value_or(joint::unlimited)};
  return ball;
}

joint::Kind kind_of(const HingeJointDescription& j) {
  return joint::Hinge{j.compliance, j.damping, j.angular_compliance, j.angular_damping,
                      axis_of(j.rotation, degree)};
}

joint::Kind kind_of(const SliderJointDescription& j) {
  return joint::Slider{j.compliance, j.damping, j.angular_compliance, j.angular_damping,
                       axis_of(j.translation, 1)};
}

joint::Kind kind_of(const UniversalJointDescription& j) {
  return joint::Universal{j.compliance,
                          j.damping,
                          j.angular_compliance,
                          j.angular_damping,
                          axis_of(j.first, degree),
                          axis_of(j.second, degree)};
}

joint::Kind kind_of(const DistanceJointDescription& j) {
  const double now = length(j.to_point - j.point);
  joint::Distance distance{.shortest = j.shortest.value_or(std::min(now, j.longest.value_or(now))),
                           .longest = j.longest.value_or(std::max(now, j.shortest.value_or(now))),
                           .compliance = j.compliance,
                           .damping = j.damping};
  if (j.motor) distance.motor = motor_of(*j.motor, 1);
  return distance;
}

joint::Kind kind_of(const PulleyJointDescription& j) {
  const double now = length(j.point - j.from_wheel) + j.ratio * length(j.to_point - j.to_wheel);
  return joint::Pulley{j.from_wheel, j.to_wheel, j.ratio, j.length.value_or(now), j.compliance, j.damping};
}

/// The object or collider of a name; none: the world.
template <class Side>
Side side_of(const World& world, const std::string& name) {
  if (name.empty()) return {};
  for (const ColliderId id : world.colliders())
    if (world.collider_options(id).name == name) return id;
  return world.find_object(name);
}

template <class Description>
JointOptions options_of(const Description& j) {
  JointOptions options{.name = j.name, .point = j.point, .collide = j.collide};
  if (j.breaking_force) options.breaking_force = *j.breaking_force;
  if (j.breaking_torque) options.breaking_torque = *j.breaking_torque;
  if constexpr (requires { j.axis; }) options.axis = j.axis;
  if constexpr (requires { j.second_axis; }) options.second_axis = j.second_axis;
  if constexpr (requires { j.to_point; }) options.point_b = j.to_point;
  return options;
}

TieOptions tie_options_of(const TieDescription& tie) {
  TieOptions options{.name = tie.name, .point_b = tie.to_point, .rest_length = tie.rest_length};
  options.compliance = tie.compliance;
  if (tie.point) options.point = *tie.point;
  if (tie.breaking_force) options.breaking_force = *tie.breaking_force;
  if (tie.breaking_strain) options.breaking_strain = *tie.breaking_strain;
  if (tie.slide) options.slide = TieSlide{tie.slide->along, tie.slide->friction};
  return options;
}

}  // namespace

void add_joint(const AnyJointDescription& joint, World& world) {
  std::visit(
      [&world](const auto& j) {
        world.add_joint(side_of<JointSide>(world, j.from), side_of<JointSide>(world, j.to), kind_of(j),
                        options_of(j));
      },
      joint);
}

void add_tie(const TieDescription& tie, World& world) {
  if (tie.stitch)
    world.stitch(world.find_object(tie.from), tie.stitch->where, world.find_object(tie.to),
                 tie.stitch->distance, tie_options_of(tie));
  else
    world.add_tie(side_of<TieSide>(world, tie.from), side_of<TieSide>(world, tie.to), tie_options_of(tie));
}

const JointDescription& common(const AnyJointDescription& joint) {
  return std::visit([](const auto& j) -> const JointDescription& { return j; }, joint);
}

JointDescription& common(AnyJointDescription& joint) {
  return std::visit([](auto& j) -> JointDescription& { return j; }, joint);
}

std::string_view kind_name(const AnyJointDescription& joint) {
  return std::visit([](const auto& j) { return joint::kind_name(kind_of(j)); }, joint);
}

}  // namespace souple
