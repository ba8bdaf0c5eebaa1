#pragma once

#include "souple/math/transform.h"

#include <functional>
#include <string_view>
#include <vector>

namespace souple {

/// A pose at a time.
struct PoseKey {
  double time = 0;  ///< s
  Vec3d translation{};
  Quatd rotation{};
};

/// Poses that differ by at most this [m, rad] are one: scripts write keyframes with rounding errors.
inline constexpr double one_pose = 1e-6;
inline bool is_one_place(const Vec3d& a, const Vec3d& b) {
  return length_squared(a - b) <= one_pose * one_pose;
}

/// The pose between two: translations linearly, rotations along the shorter arc at constant speed (slerp).
/// s = 0 and 1 give `from` and `to` exactly; scales are ignored.
Transform interpolate(const Transform& from, const Transform& to, double s);

/// The pose of a collider as a function of time: fixed, by keyframes, or by a callback. Poses are rigid: the
/// `scale` of a Transform is ignored in input and 1 in output.
class ColliderMotion {
 public:
  using Callback = std::function<Transform(double time)>;

  /// Fixed at the origin.
  ColliderMotion() = default;

  static ColliderMotion fixed(const Transform& pose);
  /// Translations are interpolated linearly, rotations along the shorter arc at constant speed (slerp).
  /// Before the first and after the last key the pose is constant; with `loop` the time wraps around to the
  /// first key. Throws Error when there is no key, times do not increase strictly or a number is not finite.
  /// `where` names the collider in the message.
  static ColliderMotion keyframes(std::vector<PoseKey> keys, bool loop = false,
                                  std::string_view where = "collider");
  /// The callback is called in every substep, for its start and its end. It must return the same pose for the
  /// same time. Throws Error when it is empty.
  static ColliderMotion callback(Callback callback);

  /// The pose at `time` [s], with a normalized rotation. Exceptions of a callback pass through: the world
  /// catches them. Throws Error when a callback's pose is not finite.
  Transform at(double time) const;

  /// True when a loop whose first and last poses differ, by more than `one_pose`, restarts between the two times. The
  /// collider then changes its pose at once, without a velocity that contacts could take over.
  bool jumps(double from, double to) const;

  /// True when the pose can never change.
  bool is_static() const { return !callback_ && keys_.size() <= 1; }

  /// The keys it was made of, for scene writers: one or none when fixed, none for a callback.
  const std::vector<PoseKey>& keys() const { return keys_; }
  bool loops() const { return loop_; }

 private:
  std::vector<PoseKey> keys_;
  bool loop_ = false;
  Callback callback_;
};

}  // namespace souple
