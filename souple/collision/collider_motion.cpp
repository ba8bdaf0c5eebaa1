#include "souple/collision/collider_motion.h"

#include "souple/error.h"
#include "souple/math/limits.h"
#include "souple/math/slerp.h"

#include <string>
#include <utility>

#include <fmt/core.h>

namespace souple {
namespace {

bool is_finite(const Quatd& q) {
  return std::isfinite(q.x) && std::isfinite(q.y) && std::isfinite(q.z) && std::isfinite(q.w);
}

/// q and -q are one rotation. |a - b| of unit quaternions is half the angle between them, if that is small.
bool is_one_rotation(const Quatd& a, const Quatd& b) {
  const auto square = [&](double sign) {
    const Quatd d{a.x - sign * b.x, a.y - sign * b.y, a.z - sign * b.z, a.w - sign * b.w};
    return d.x * d.x + d.y * d.y + d.z * d.z + d.w * d.w;
  };
  constexpr double largest = one_pose / 2;
  return min(square(1), square(-1)) <= largest * largest;
}

}  // namespace

Transform interpolate(const Transform& from, const Transform& to, double s) {
  if (s <= 0) return {from.translation, from.rotation, 1};
  if (s >= 1) return {to.translation, to.rotation, 1};
  return {from.translation + (to.translation - from.translation) * s, slerp(from.rotation, to.rotation, s),
          1};
}

ColliderMotion ColliderMotion::fixed(const Transform& pose) {
  ColliderMotion motion;
  motion.keys_.push_back({0, pose.translation, normalized(pose.rotation)});
  return motion;
}

ColliderMotion ColliderMotion::keyframes(std::vector<PoseKey> keys, bool loop, std::string_view where) {
  if (keys.empty()) throw Error(std::string(where) + ": no keyframes; expected at least one");
  for (std::size_t k = 0; k < keys.size(); ++k) {
    const std::string key = fmt::format("{}: keyframe {}", where, k);
    if (!std::isfinite(keys[k].time) || !souple::is_finite(keys[k].translation) ||
        !is_finite(keys[k].rotation))
      throw Error(key + " has a number that is not finite; expected finite numbers");
    if (!(std::abs(keys[k].time) <= range::time) || !is_within(keys[k].translation, range::coordinate))
      throw Error(fmt::format("{} is at {:g} s and ({:g}, {:g}, {:g}); expected at most {:g} s and {:g} m",
                              key, keys[k].time, keys[k].translation.x, keys[k].translation.y,
                              keys[k].translation.z, range::time, range::coordinate));
    if (k > 0 && !(keys[k].time > keys[k - 1].time))
      throw Error(key + " is not later than the one before it; expected times that increase");
    keys[k].rotation = normalized(keys[k].rotation);
  }
  ColliderMotion motion;
  motion.keys_ = std::move(keys);
  motion.loop_ = loop;
  return motion;
}

ColliderMotion ColliderMotion::callback(Callback callback) {
  if (!callback) throw Error("collider motion: the callback is empty; expected a function of time");
  ColliderMotion motion;
  motion.callback_ = std::move(callback);
  return motion;
}

bool ColliderMotion::jumps(double from, double to) const {
  if (!loop_ || keys_.size() < 2) return false;
  const PoseKey &first = keys_.front(), &last = keys_.back();
  if (is_one_place(first.translation, last.translation) && is_one_rotation(first.rotation, last.rotation))
    return false;
  const double period = last.time - first.time;
  return std::floor((from - first.time) / period) != std::floor((to - first.time) / period);
}

Transform ColliderMotion::at(double time) const {
  if (callback_) {
    const Transform pose = callback_(time);
    if (!is_within(pose.translation, range::coordinate) || !is_finite(pose.rotation))
      throw Error(
          fmt::format("collider motion: the callback's pose at {:g} s is not finite, or more than {:g} m "
                      "from the origin",
                      time, range::coordinate));
    return {pose.translation, normalized(pose.rotation), 1};
  }
  if (keys_.empty()) return {};
  const double first = keys_.front().time, last = keys_.back().time;
  if (loop_ && last > first) {
    time = std::fmod(time - first, last - first);
    time = first + (time < 0 ? time + (last - first) : time);
  }
  std::size_t next = 0;
  while (next < keys_.size() && keys_[next].time <= time) ++next;
  if (next == 0) return {keys_.front().translation, keys_.front().rotation, 1};
  if (next == keys_.size()) return {keys_.back().translation, keys_.back().rotation, 1};
  const PoseKey &a = keys_[next - 1], &b = keys_[next];
  const double s = (time - a.time) / (b.time - a.time);
  return {a.translation + (b.translation - a.translation) * s, slerp(a.rotation, b.rotation, s), 1};
}

}  // namespace souple
