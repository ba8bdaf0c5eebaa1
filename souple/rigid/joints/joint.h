#pragma once

#include "souple/rigid/impulse.h"
#include "souple/rigid/joints/ball.h"
#include "souple/rigid/joints/distance.h"
#include "souple/rigid/joints/fixed.h"
#include "souple/rigid/joints/hinge.h"
#include "souple/rigid/joints/pulley.h"
#include "souple/rigid/joints/slider.h"
#include "souple/rigid/joints/universal.h"

#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace souple::joint {

struct Kind : std::variant<Fixed, Ball, Hinge, Slider, Universal, Distance, Pulley> {
  using variant::variant;
};
/// "fixed", "ball", ...
std::string_view kind_name(const Kind& kind);

/// A joint between two bodies, or a body and the world: then one of both is no_body, and its frame is in the world.
struct Joint {
  std::string name;
  std::uint32_t a = no_body, b = no_body;
  Frame frame_a{}, frame_b{};
  Kind kind{};
  double breaking_force = unlimited;   ///< N
  double breaking_torque = unlimited;  ///< N m
};

/// State of a joint that one substep passes to the next, with its reported forces.
struct JointState {
  std::array<double, Rows::most> lambda{};  ///< impulse of each row in the last substep [kg m] or [kg m^2]
  std::array<double, Rows::most> value{};   ///< of each row at the start of the last substep [m] or [rad]
  /// A range is at its low end (-1), at its high end (1) or within (0). A limited force is at its limit (-1, 1) or
  /// below (0).
  std::array<std::int8_t, Rows::most> at{};
  std::array<double, 2> angle{};  ///< of hinge and universal, counted over full turns [rad]
  double h = 0;                   ///< of the last substep; 0 before the first one [s]
  Vec3d force{};                  ///< on b in the last substep, in world axes [N]
  Vec3d torque{};                 ///< on b about the joint's point [N m]
  bool broken = false;
};

/// All joints of a world.
struct Joints {
  std::vector<Joint> joint;
  std::vector<JointState> state;  ///< as `joint`

  std::size_t size() const { return joint.size(); }
};

/// Throws Error with the joint's name if the description is invalid for a world of `body_count` bodies.
void validate(const Joint& joint, std::size_t body_count);

/// Adds a valid joint and returns its index. Throws Error as `validate`.
std::uint32_t add(Joints& joints, Joint joint, std::size_t body_count);

/// Both frames on a point and axes of the world, where the bodies are now. The joint's first axis is that of `axes`.
void place(Joint& joint, const RigidBodies& bodies, const Vec3d& point, const Quatd& axes = {});

/// The rotation that turns the first axis into the direction of `axis`. An axis without length gives zero, which `add`
/// refuses.
Quatd axes_along(const Vec3d& axis);

/// Where the frames are, for the given poses of the bodies.
Ends ends_of(const Joint& joint, const BodyPose& a, const BodyPose& b, const std::array<double, 2>& angle);
/// For the bodies' present poses.
Ends ends_of(const Joint& joint, const JointState& state, const RigidBodies& bodies);
Rows rows_of(const Joint& joint, const Ends& ends);

/// Position of a joint along its free coordinates. Hinge: angle [rad]; slider: shift [m]; universal: both angles [rad];
/// ball: swing and twist [rad]; distance: the distance [m]; pulley: length of the rope in use [m]. Else 0.
std::array<double, 2> coordinates_of(const Joint& joint, const Ends& ends);

/// Distance and angle by which a joint violates its rigid rows.
struct JointError {
  double distance = 0;  ///< m
  double angle = 0;     ///< rad
};
JointError error_of(const Joint& joint, const Ends& ends);
/// 0 for a broken joint.
JointError error_of(const Joint& joint, const JointState& state, const RigidBodies& bodies);

}  // namespace souple::joint
