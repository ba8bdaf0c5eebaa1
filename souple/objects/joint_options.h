#pragma once

#include "souple/math/vec3.h"
#include "souple/objects/handles.h"

#include <array>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <variant>

namespace souple {

/// One side of a joint: a rigid body, a collider, or the world, which does not move.
class JointSide {
 public:
  JointSide() = default;  ///< the world
  JointSide(ObjectId rigid_body) : what_(rigid_body) {}
  JointSide(ColliderId collider) : what_(collider) {}

  const ObjectId* object() const { return std::get_if<ObjectId>(&what_); }
  const ColliderId* collider() const { return std::get_if<ColliderId>(&what_); }
  bool is_world() const { return what_.index() == 0; }
  friend bool operator==(const JointSide&, const JointSide&) = default;

 private:
  std::variant<std::monostate, ObjectId, ColliderId> what_;
};

/// Where a joint is when it is added, in world axes. Its sides are joined as they then lie: angles and shifts are 0.
struct JointOptions {
  std::string name{};              ///< empty: "hinge", "hinge2", ...
  Vec3d point{};                   ///< of both sides [m]
  std::optional<Vec3d> point_b{};  ///< that of b if it is elsewhere, for distance and pulley [m]
  Vec3d axis{1, 0, 0};             ///< the first axis: of a hinge, a slider, the twist of a ball
  /// The third axis: that of b in a universal joint. Not given: any that is perpendicular to the first.
  std::optional<Vec3d> second_axis{};
  double breaking_force = std::numeric_limits<double>::infinity();   ///< N
  double breaking_torque = std::numeric_limits<double>::infinity();  ///< N m
  bool collide = false;  ///< whether both sides collide with each other
};

/// State and forces of a joint.
struct JointReport {
  std::string_view name{};             ///< valid until the joint is removed
  Vec3d point_a{}, point_b{};          ///< in the world [m]
  Vec3d axis{};                        ///< the first axis, of a
  Vec3d force{};                       ///< on b, in the last substep of a step [N]
  Vec3d torque{};                      ///< on b, about the joint's point [N m]
  std::array<double, 2> coordinate{};  ///< see joint::coordinates_of [rad] or [m]
  double distance_error = 0;           ///< distance by which it violates its rigid rows [m]
  double angle_error = 0;              ///< rad
  bool broken = false;
};

}  // namespace souple
