#pragma once

#include "souple/math/transform.h"
#include "souple/objects/object.h"
#include "souple/objects/obstacle_motion.h"

#include <cstddef>
#include <cstdint>
#include <string_view>
#include <vector>

namespace souple {

/// Throws Error if a sequence has another vertex count, non-finite values or times that do not increase.
void validate(const ObstacleMotion& motion, std::size_t vertices, std::string_view owner);

bool is_static(const ObstacleMotion& motion);
/// Whether the motion moves vertices against each other; else `pose` moves the rest positions.
inline bool deforms(const ObstacleMotion& motion) {
  return !motion.sequence.frames.empty();
}
/// Whether a loop with different ends restarts between the two times [s].
bool jumps(const ObstacleMotion& motion, double from, double to);

/// An obstacle at one time [s]: computes the data common to its particles once. Passes exceptions of callbacks on.
class ObstaclePose {
 public:
  /// `object` must outlive it.
  ObstaclePose(const Object& object, double time);
  /// Position of a particle of the object [m].
  Vec3d position(std::uint32_t particle) const {
    if (before_ == nullptr) return pose_.point(object_.rest[particle]);
    const std::uint32_t vertex = object_.vertex_of[particle];
    const Vec3d a((*before_)[vertex]), b((*after_)[vertex]);
    return pose_.point(object_.motion.placement.point(a + (b - a) * part_));
  }

 private:
  void find_frames(const MeshSequence& sequence, double time);

  const Object& object_;
  Transform pose_;
  const std::vector<Vec3f>*before_ = nullptr, *after_ = nullptr;
  double part_ = 0;
};

/// Positions of an obstacle's particles at `time` [s]. Passes exceptions of callbacks on.
std::vector<Vec3d> obstacle_positions(const Object& object, double time);

}  // namespace souple
