#include "souple/objects/obstacle_pose.h"

#include "souple/error.h"
#include "souple/math/limits.h"

#include <algorithm>
#include <cmath>
#include <string>

#include <fmt/core.h>

namespace souple {
namespace {

double frame_time(const MeshSequence& sequence, std::size_t frame) {
  return sequence.times.empty() ? static_cast<double>(frame) / sequence.frame_rate : sequence.times[frame];
}

double duration(const MeshSequence& sequence) {
  return frame_time(sequence, sequence.frames.size() - 1);
}

// Whether a loop with different ends restarts between the two times.
bool jumps(const MeshSequence& sequence, double from, double to) {
  if (!sequence.loop || sequence.frames.size() < 2) return false;
  const double period = duration(sequence), start = sequence.start_time;
  const std::vector<Vec3f>&first = sequence.frames.front(), &last = sequence.frames.back();
  return std::floor((from - start) / period) != std::floor((to - start) / period) &&
         !std::equal(first.begin(), first.end(), last.begin(), last.end(),
                     [](const Vec3f& a, const Vec3f& b) { return is_one_place(Vec3d(a), Vec3d(b)); });
}

void validate_times(const MeshSequence& sequence, const std::string& where) {
  if (!(sequence.frame_rate > 0) || !std::isfinite(sequence.frame_rate))
    throw Error(
        fmt::format("{}: the frame rate is {}, expected a finite number > 0", where, sequence.frame_rate));
  if (!(std::abs(sequence.start_time) <= range::time))
    throw Error(fmt::format("{}: the start time is {:g} s, expected a number from {:g} to {:g}", where,
                            sequence.start_time, -range::time, range::time));
  if (sequence.times.empty()) return;
  if (sequence.times.size() != sequence.frames.size())
    throw Error(fmt::format("{}: there are {} times for {} frames", where, sequence.times.size(),
                            sequence.frames.size()));
  if (sequence.times[0] != 0) throw Error(where + ": the time of frame 0 is not 0");
  for (std::size_t k = 1; k < sequence.times.size(); ++k)
    if (!(sequence.times[k] > sequence.times[k - 1]) || !std::isfinite(sequence.times[k]))
      throw Error(
          fmt::format("{}: the time of frame {} is not later than that of the frame before", where, k));
}

}  // namespace

bool is_static(const ObstacleMotion& motion) {
  return motion.pose.is_static() && motion.sequence.frames.size() <= 1;
}

bool jumps(const ObstacleMotion& motion, double from, double to) {
  return motion.pose.jumps(from, to) || jumps(motion.sequence, from, to);
}

ObstaclePose::ObstaclePose(const Object& object, double time)
    : object_(object), pose_(object.motion.pose.at(time)) {
  if (!object.motion.sequence.frames.empty()) find_frames(object.motion.sequence, time);
}

void ObstaclePose::find_frames(const MeshSequence& sequence, double time) {
  const std::size_t count = sequence.frames.size();
  const double length = duration(sequence);
  double t = time - sequence.start_time;
  if (sequence.loop && length > 0) t -= std::floor(t / length) * length;
  std::size_t next = 0;
  if (sequence.times.empty()) {
    next = t < 0 ? 0 : static_cast<std::size_t>(std::min(t * sequence.frame_rate, double(count))) + 1;
  } else {
    next = static_cast<std::size_t>(std::upper_bound(sequence.times.begin(), sequence.times.end(), t) -
                                    sequence.times.begin());
  }
  const std::size_t last = next == 0 ? 0 : std::min(next, count) - 1;
  before_ = after_ = &sequence.frames[last];
  if (next == 0 || next >= count) return;
  after_ = &sequence.frames[next];
  const double begin = frame_time(sequence, last);
  part_ = std::clamp((t - begin) / (frame_time(sequence, next) - begin), 0.0, 1.0);
}

void validate(const ObstacleMotion& motion, std::size_t vertices, std::string_view owner) {
  const MeshSequence& sequence = motion.sequence;
  if (sequence.frames.empty()) return;
  const std::string where = std::string(owner) + ": the sequence";
  validate_times(sequence, where);
  for (std::size_t k = 0; k < sequence.frames.size(); ++k) {
    const std::vector<Vec3f>& frame = sequence.frames[k];
    if (frame.size() != vertices)
      throw Error(fmt::format("{} has {} vertices in frame {}, but the mesh has {}", where, frame.size(), k,
                              vertices));
    for (std::size_t i = 0; i < frame.size(); ++i)
      if (!is_within(frame[i], range::coordinate))
        throw Error(
            fmt::format("{} has a position that is not finite or beyond {:g} m in frame {} at vertex {}",
                        where, range::coordinate, k, i));
  }
}

std::vector<Vec3d> obstacle_positions(const Object& object, double time) {
  const ObstaclePose pose(object, time);
  std::vector<Vec3d> result;
  result.reserve(object.rest.size());
  for (std::uint32_t k = 0; k < object.particle_count(); ++k) result.push_back(pose.position(k));
  return result;
}

}  // namespace souple
