#include "python/bind.h"
#include "python/enums.h"
#include "python/structs.h"
#include "souple/objects/joint_options.h"
#include "souple/rigid/joints/joint.h"

namespace souple::python {

void bind_joints(py::module_& m) {
  py::module_ j = m.def_submodule("joint", "Kinds of joints of rigid bodies, and what they are made of.");
  m.attr("joint") = j;
  Struct<joint::Limits>(j, "Limits")
      .fields<&joint::Limits::low, &joint::Limits::high, &joint::Limits::compliance,
              &joint::Limits::damping>();
  Struct<joint::Spring>(j, "Spring")
      .fields<&joint::Spring::rest, &joint::Spring::compliance, &joint::Spring::damping>();
  Struct<joint::Motor> motor(j, "Motor");
  bind_motor_target(motor.python_class());
  motor.fields<&joint::Motor::kind, &joint::Motor::target, &joint::Motor::max_force,
               &joint::Motor::compliance, &joint::Motor::damping>();
  Struct<joint::Axis>(j, "Axis").fields<&joint::Axis::limits, &joint::Axis::spring, &joint::Axis::motor>();
  Struct<joint::RotationSpring>(j, "RotationSpring")
      .fields<&joint::RotationSpring::target, &joint::RotationSpring::compliance,
              &joint::RotationSpring::damping, &joint::RotationSpring::max_torque>();
  Struct<joint::Fixed>(j, "Fixed")
      .fields<&joint::Fixed::compliance, &joint::Fixed::damping, &joint::Fixed::angular_compliance,
              &joint::Fixed::angular_damping>();
  Struct<joint::Ball>(j, "Ball")
      .fields<&joint::Ball::compliance, &joint::Ball::damping, &joint::Ball::max_swing,
              &joint::Ball::swing_compliance, &joint::Ball::twist, &joint::Ball::spring>();
  Struct<joint::Hinge>(j, "Hinge")
      .fields<&joint::Hinge::compliance, &joint::Hinge::damping, &joint::Hinge::angular_compliance,
              &joint::Hinge::angular_damping, &joint::Hinge::rotation>();
  Struct<joint::Slider>(j, "Slider")
      .fields<&joint::Slider::compliance, &joint::Slider::damping, &joint::Slider::angular_compliance,
              &joint::Slider::angular_damping, &joint::Slider::translation>();
  Struct<joint::Universal>(j, "Universal")
      .fields<&joint::Universal::compliance, &joint::Universal::damping,
              &joint::Universal::angular_compliance, &joint::Universal::angular_damping,
              &joint::Universal::first, &joint::Universal::second>();
  Struct<joint::Distance>(j, "Distance")
      .fields<&joint::Distance::shortest, &joint::Distance::longest, &joint::Distance::compliance,
              &joint::Distance::damping, &joint::Distance::motor>();
  Struct<joint::Pulley>(j, "Pulley")
      .fields<&joint::Pulley::wheel_a, &joint::Pulley::wheel_b, &joint::Pulley::ratio, &joint::Pulley::length,
              &joint::Pulley::compliance, &joint::Pulley::damping>();
  Struct<JointOptions>(m, "JointOptions")
      .fields<&JointOptions::name, &JointOptions::point, &JointOptions::point_b, &JointOptions::axis,
              &JointOptions::second_axis, &JointOptions::breaking_force, &JointOptions::breaking_torque,
              &JointOptions::collide>();
  Result<JointReport>(m, "JointReport")
      .fields<&JointReport::name, &JointReport::point_a, &JointReport::point_b, &JointReport::axis,
              &JointReport::force, &JointReport::torque, &JointReport::coordinate,
              &JointReport::distance_error, &JointReport::angle_error, &JointReport::broken>();
}

}  // namespace souple::python
