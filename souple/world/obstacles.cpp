#include "souple/world/obstacles.h"

#include "souple/objects/object.h"
#include "souple/world/contact_state.h"

#include <algorithm>
#include <cmath>
#include <string>

#include <fmt/core.h>

namespace souple {

bool is_static(const ObstacleMotion& motion) {
  return motion.pose.is_static() && motion.sequence.frames.size() <= 1;
}

namespace {

// Minimum number of particles per thread.
constexpr std::size_t grain = 2048;

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
  return std::floor((from - start) / period) != std::floor((to - start) / period) &&
         sequence.frames.front() != sequence.frames.back();
}

bool jumps(const ObstacleMotion& motion, double from, double to) {
  return motion.pose.jumps(from, to) || jumps(motion.sequence, from, to);
}

/// An obstacle at one time: computes the data common to its particles once.
class Moment {
 public:
  Moment(const Object& object, double time) : object_(object), pose_(object.motion.pose.at(time)) {
    if (!object.motion.sequence.frames.empty()) find_frames(object.motion.sequence, time);
  }

  Vec3d position(std::uint32_t particle) const {
    if (before_ == nullptr) return pose_.point(object_.rest[particle]);
    const std::uint32_t vertex = object_.vertex_of[particle];
    const Vec3d a((*before_)[vertex]), b((*after_)[vertex]);
    return pose_.point(object_.placement.point(a + (b - a) * part_));
  }

 private:
  void find_frames(const MeshSequence& sequence, double time) {
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

  const Object& object_;
  Transform pose_;
  const std::vector<Vec3f>*before_ = nullptr, *after_ = nullptr;
  double part_ = 0;
};

/// Calls f(i, position) for each particle i of an obstacle at a time; in any order, from several threads.
template <class Function>
void at_moment(WorldState& world, const Object& object, double time, const Function& f) {
  world.warnings.guarded("an obstacle's motion", [&] {
    const Moment moment(object, time);
    world.threads->for_each(object.particle_count(), grain, [&](std::size_t begin, std::size_t end) {
      for (std::size_t k = begin; k < end; ++k)
        f(object.begin + k, moment.position(static_cast<std::uint32_t>(k)));
    });
  });
}

void validate_times(const MeshSequence& sequence, const std::string& where) {
  if (!(sequence.frame_rate > 0) || !std::isfinite(sequence.frame_rate))
    throw Error(
        fmt::format("{}: the frame rate is {}, expected a finite number > 0", where, sequence.frame_rate));
  if (!std::isfinite(sequence.start_time)) throw Error(where + ": the start time is not finite");
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
      if (!is_finite(frame[i]) || length(Vec3d(frame[i])) > 1e15)
        throw Error(fmt::format(
            "{} has a position that is not finite or beyond 1e15 m in frame {} at vertex {}", where, k, i));
  }
}

std::vector<Vec3d> obstacle_positions(const Object& object, double time) {
  const Moment moment(object, time);
  std::vector<Vec3d> result;
  result.reserve(object.rest.size());
  for (std::uint32_t k = 0; k < object.particle_count(); ++k) result.push_back(moment.position(k));
  return result;
}

void predict_obstacles(WorldState& world, double dt) {
  for (const auto& object : world.objects) {
    if (object->kind != ObjectKind::obstacle || is_static(object->motion) ||
        jumps(object->motion, world.time, world.time + dt))
      continue;
    at_moment(world, *object, world.time + dt, [&](std::size_t i, const Vec3d& x) {
      world.particles.velocity[i].set_xyz(Vec3f((x - world.exact_position(i)) / dt));
    });
  }
}

void drive_obstacles(WorldState& world, const Substep& substep) {
  const double t = world.time + static_cast<double>(substep.h);
  Particles& particles = world.particles;
  const bool plain = world.settings.form == Form::plain;
  std::vector<Vec4f>& p = plain ? particles.position : particles.offset;
  for (const auto& object : world.objects) {
    if (object->kind != ObjectKind::obstacle || is_static(object->motion)) continue;
    const bool jump = jumps(object->motion, world.time, t);
    world.contact->check_intersections = world.contact->check_intersections || jump;
    at_moment(world, *object, t, [&](std::size_t i, const Vec3d& x) {
      p[i].set_xyz(Vec3f(plain ? x : x - Vec3d(particles.position[i].xyz())));
      if (jump) particles.start[i].set_xyz(p[i].xyz());  // it did not move there
    });
  }
}

}  // namespace souple
