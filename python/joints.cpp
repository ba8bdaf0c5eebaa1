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
      .field<&joint::Limits::low>("low")
      .field<&joint::Limits::high>("high")
      .field<&joint::Limits::compliance>("compliance")
      .field<&joint::Limits::damping>("damping");
  Struct<joint::Spring>(j, "Spring")
      .field<&joint::Spring::rest>("rest")
      .field<&joint::Spring::compliance>("compliance")
      .field<&joint::Spring::damping>("damping");
  Struct<joint::Motor> motor(j, "Motor");
  bind_motor_target(motor.python_class());
  motor.field<&joint::Motor::kind>("kind")
      .field<&joint::Motor::target>("target")
      .field<&joint::Motor::max_force>("max_force")
      .field<&joint::Motor::compliance>("compliance")
      .field<&joint::Motor::damping>("damping");
  Struct<joint::Axis>(j, "Axis")
      .field<&joint::Axis::limits>("limits")
      .field<&joint::Axis::spring>("spring")
      .field<&joint::Axis::motor>("motor");
  Struct<joint::RotationSpring>(j, "RotationSpring")
      .field<&joint::RotationSpring::target>("target")
      .field<&joint::RotationSpring::compliance>("compliance")
      .field<&joint::RotationSpring::damping>("damping")
      .field<&joint::RotationSpring::max_torque>("max_torque");
  Struct<joint::Fixed>(j, "Fixed")
      .field<&joint::Fixed::compliance>("compliance")
      .field<&joint::Fixed::damping>("damping")
      .field<&joint::Fixed::angular_compliance>("angular_compliance")
      .field<&joint::Fixed::angular_damping>("angular_damping");
  Struct<joint::Ball>(j, "Ball")
      .field<&joint::Ball::compliance>("compliance")
      .field<&joint::Ball::damping>("damping")
      .field<&joint::Ball::max_swing>("max_swing")
      .field<&joint::Ball::swing_compliance>("swing_compliance")
      .field<&joint::Ball::twist>("twist")
      .field<&joint::Ball::spring>("spring");
  Struct<joint::Hinge>(j, "Hinge")
      .field<&joint::Hinge::compliance>("compliance")
      .field<&joint::Hinge::damping>("damping")
      .field<&joint::Hinge::angular_compliance>("angular_compliance")
      .field<&joint::Hinge::angular_damping>("angular_damping")
      .field<&joint::Hinge::rotation>("rotation");
  Struct<joint::Slider>(j, "Slider")
      .field<&joint::Slider::compliance>("compliance")
      .field<&joint::Slider::damping>("damping")
      .field<&joint::Slider::angular_compliance>("angular_compliance")
      .field<&joint::Slider::angular_damping>("angular_damping")
      .field<&joint::Slider::translation>("translation");
  Struct<joint::Universal>(j, "Universal")
      .field<&joint::Universal::compliance>("compliance")
      .field<&joint::Universal::damping>("damping")
      .field<&joint::Universal::angular_compliance>("angular_compliance")
      .field<&joint::Universal::angular_damping>("angular_damping")
      .field<&joint::Universal::first>("first")
      .field<&joint::Universal::second>("second");
  Struct<joint::Distance>(j, "Distance")
      .field<&joint::Distance::shortest>("shortest")
      .field<&joint::Distance::longest>("longest")
      .field<&joint::Distance::compliance>("compliance")
      .field<&joint::Distance::damping>("damping")
      .field<&joint::Distance::motor>("motor");
  Struct<joint::Pulley>(j, "Pulley")
      .field<&joint::Pulley::wheel_a>("wheel_a")
      .field<&joint::Pulley::wheel_b>("wheel_b")
      .field<&joint::Pulley::ratio>("ratio")
      .field<&joint::Pulley::length>("length")
      .field<&joint::Pulley::compliance>("compliance")
      .field<&joint::Pulley::damping>("damping");
  Struct<JointOptions>(m, "JointOptions")
      .field<&JointOptions::name>("name")
      .field<&JointOptions::point>("point")
      .field<&JointOptions::point_b>("point_b")
      .field<&JointOptions::axis>("axis")
      .field<&JointOptions::second_axis>("second_axis")
      .field<&JointOptions::breaking_force>("breaking_force")
      .field<&JointOptions::breaking_torque>("breaking_torque")
      .field<&JointOptions::collide>("collide");
  Result<JointReport>(m, "JointReport")
      .field<&JointReport::name>("name")
      .field<&JointReport::point_a>("point_a")
      .field<&JointReport::point_b>("point_b")
      .field<&JointReport::axis>("axis")
      .field<&JointReport::force>("force")
      .field<&JointReport::torque>("torque")
      .field<&JointReport::coordinate>("coordinate")
      .field<&JointReport::distance_error>("distance_error")
      .field<&JointReport::angle_error>("angle_error")
      .field<&JointReport::broken>("broken");
}

}  // namespace souple::python
