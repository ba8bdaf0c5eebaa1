#pragma once

#include "souple/math/transform.h"

#include <functional>
#include <string_view>
#include <vector>

namespace souple {

/// A pose at a moment.
struct PoseKey {
  double time = 0;  ///< s
  Vec3d translation{};
  Quatd rotation{};
};

/// Where a collider is as a function of time: fixed, through keyframes, or asked of a callback. Poses are
/// rigid: `scale` of a Transform is ignored here and always 1 in what comes out.
class ColliderMotion {
 public:
  using Callback = std::function<Transform(double time)>;

  /// Fixed at the origin.
  ColliderMotion() = default;

  static ColliderMotion fixed(const Transform& pose);
  /// Translations are interpolated linearly, rotations along the shorter arc at constant speed (slerp).
  /// Before the first and after the last key the pose stays; with `loop` the time wraps round to the first
  /// key. Throws Error when there is no key, times do not increase strictly or a number is not finite;
  /// `where` names the collider in the message.
  static ColliderMotion keyframes(std::vector<PoseKey> keys, bool loop = false,
                                  std::string_view where = "collider");
  /// Asked at every substep, for its begin and its end; must answer alike when asked twice. Throws Error when
  /// the callback is empty.
  static ColliderMotion callback(Callback callback);

  /// The pose at `time` [s], its rotation normalized. What a callback throws passes through: the world
  /// catches it. Throws Error when a callback's pose is not finite.
  Transform at(double time) const;

  /// True when a loop whose ends differ starts again between the two times: the collider is then somewhere
  /// else at once, and has no velocity that it could pass on.
  bool jumps(double from, double to) const;

  /// True when the pose can never change.
  bool is_static() const { return !callback_ && keys_.size() <= 1; }

  /// What it was made of, for those who write scenes back: one key or none when fixed, none for a callback.
  const std::vector<PoseKey>& keys() const { return keys_; }
  bool loops() const { return loop_; }

 private:
  std::vector<PoseKey> keys_;
  bool loop_ = false;
  Callback callback_;
};

}  // namespace souple
