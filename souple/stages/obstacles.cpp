#include "souple/stages/obstacles.h"

#include "souple/objects/kind_traits.h"
#include "souple/objects/object.h"
#include "souple/objects/obstacle_pose.h"

namespace souple {

namespace {

// Minimum number of particles per thread.
constexpr std::size_t obstacle_grain = 2048;

/// Calls f(i, position) for each particle i of an obstacle at a time; in any order, from several threads.
template <class Function>
void at_moment(const StageView& stage, const Object& object, double time, const Function& f) {
  stage.warnings.guarded("an obstacle's motion", [&] {
    const ObstaclePose pose(object, time);
    stage.threads.for_each(object.particle_count(), obstacle_grain, [&](std::size_t begin, std::size_t end) {
      for (std::size_t k = begin; k < end; ++k)
        f(object.begin + k, pose.position(static_cast<std::uint32_t>(k)));
    });
  });
}

}  // namespace

void predict_obstacles(const StageView& stage, double dt) {
  const ObjectsView& objects = stage.objects;
  for (const auto& object : objects.objects) {
    if (!object->traits().driven || is_static(object->motion) ||
        jumps(object->motion, stage.time, stage.time + dt))
      continue;
    at_moment(stage, *object, stage.time + dt, [&](std::size_t i, const Vec3d& x) {
      objects.particles.velocity[i].set_xyz(Vec3f((x - objects.particles.exact_position(i)) / dt));
    });
  }
}

bool drive_obstacles(const StageView& stage, const Substep& substep) {
  const double t = stage.time + static_cast<double>(substep.h);
  Particles& particles = stage.objects.particles;
  bool any_jump = false;
  for (const auto& object : stage.objects.objects) {
    if (!object->traits().driven || is_static(object->motion)) continue;
    const bool jump = jumps(object->motion, stage.time, t);
    any_jump = any_jump || jump;
    at_moment(stage, *object, t, [&](std::size_t i, const Vec3d& x) {
      particles.offset[i].set_xyz(Vec3f(x - Vec3d(particles.position[i].xyz())));
      if (jump) particles.start[i].set_xyz(particles.offset[i].xyz());  // it did not move there
    });
  }
  return any_jump;
}

}  // namespace souple
