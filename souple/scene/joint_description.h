#pragma once

#include "souple/math/vec3.h"

#include <optional>
#include <string>
#include <variant>

// Joints of a scene file, as in souple/rigid/joints/, but angles are in degrees. Part of scene.h.

namespace souple {

struct JointLimitsDescription {
  std::optional<double> low, high;  ///< m or degrees
  double compliance = 0;            ///< m/N or rad/(N m)
  double damping = 0;               ///< N s/m or N m s/rad
};
struct JointSpringDescription {
  double rest = 0;                   ///< m or degrees
  std::optional<double> compliance;  ///< m/N or rad/(N m); if not given, a damper alone
  double damping = 0;                ///< N s/m or N m s/rad
};
/// With one of a velocity and a position.
struct JointMotorDescription {
  std::optional<double> velocity;   ///< m/s or rad/s
  std::optional<double> position;   ///< m or degrees
  std::optional<double> max_force;  ///< N or N m; if not given, any
  double compliance = 0;            ///< of a position [m/N] or [rad/(N m)]
  double damping = 0;               ///< of a position [N s/m] or [N m s/rad]
};
/// Forces along one degree of freedom.
struct JointAxisDescription {
  std::optional<JointLimitsDescription> limits;
  std::optional<JointSpringDescription> spring;
  std::optional<JointMotorDescription> motor;
};

struct JointDescription {
  std::string name;
  std::string from;                       ///< a rigid body or collider; empty: the world
  std::string to;                         ///< a rigid body
  Vec3d point{};                          ///< m
  std::optional<double> breaking_force;   ///< N; if not given, it does not break
  std::optional<double> breaking_torque;  ///< N m
  bool collide = false;                   ///< the two bodies with each other
  double compliance = 0;                  ///< m/N
  double damping = 0;                     ///< N s/m
};
/// Joints that hold axes.
struct AxialJointDescription : JointDescription {
  Vec3d axis{1, 0, 0};
  double angular_compliance = 0;  ///< rad/(N m)
  double angular_damping = 0;     ///< N m s/rad
};
struct FixedJointDescription : AxialJointDescription {};
/// Pulls the axes of `to` back to where they were.
struct BallSpringDescription {
  double compliance = 0;             ///< rad/(N m)
  double damping = 0;                ///< N m s/rad
  std::optional<double> max_torque;  ///< N m; if not given, any
};
struct BallJointDescription : JointDescription {
  Vec3d axis{1, 0, 0};              ///< of the twist
  std::optional<double> max_swing;  ///< degrees
  double swing_compliance = 0;      ///< rad/(N m)
  std::optional<JointLimitsDescription> twist;
  std::optional<BallSpringDescription> spring;
};
struct HingeJointDescription : AxialJointDescription {
  JointAxisDescription rotation;
};
struct SliderJointDescription : AxialJointDescription {
  JointAxisDescription translation;
};
struct UniversalJointDescription : AxialJointDescription {
  std::optional<Vec3d> second_axis;  ///< of `to`, perpendicular to the axis; if not given, any
  JointAxisDescription first, second;
};
struct DistanceJointDescription : JointDescription {
  Vec3d to_point{};                         ///< where it holds `to` [m]
  std::optional<double> shortest, longest;  ///< m; if neither is given, the distance at the start
  std::optional<JointMotorDescription> motor;
};
struct PulleyJointDescription : JointDescription {
  Vec3d to_point{};                ///< where it holds `to` [m]
  Vec3d from_wheel{}, to_wheel{};  ///< where the rope leaves for both [m]
  double ratio = 1;
  std::optional<double> length;  ///< of the rope [m]; if not given, taut at the start
};

using AnyJointDescription =
    std::variant<FixedJointDescription, BallJointDescription, HingeJointDescription, SliderJointDescription,
                 UniversalJointDescription, DistanceJointDescription, PulleyJointDescription>;
/// The fields that all kinds share.
const JointDescription& common(const AnyJointDescription& joint);
JointDescription& common(AnyJointDescription& joint);
/// "fixed", "hinge", ...
std::string_view kind_name(const AnyJointDescription& joint);

}  // namespace souple
