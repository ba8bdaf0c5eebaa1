#include "souple/world/obstacles.h"

#include "souple/objects/kind_traits.h"
#include "souple/objects/object.h"
#include "souple/objects/obstacle_pose.h"
#include "souple/world/contact_state.h"

namespace souple {

namespace {

// Minimum number of particles per thread.
constexpr std::size_t grain = 2048;

/// Calls f(i, position) for each particle i of an obstacle at a time; in any order, from several threads.
template <class Function>
void at_moment(WorldState& world, const Object& object, double time, const Function& f) {
  world.warnings.guarded("an obstacle's motion", [&] {
    const ObstaclePose pose(object, time);
    world.threads->for_each(object.particle_count(), grain, [&](std::size_t begin, std::size_t end) {
      for (std::size_t k = begin; k < end; ++k)
        f(object.begin + k, pose.position(static_cast<std::uint32_t>(k)));
    });
  });
}

}  // namespace

void predict_obstacles(WorldState& world, double dt) {
  for (const auto& object : world.objects) {
    if (!object->traits().driven || is_static(object->motion) ||
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
    if (!object->traits().driven || is_static(object->motion)) continue;
    const bool jump = jumps(object->motion, world.time, t);
    world.contact->check_intersections = world.contact->check_intersections || jump;
    at_moment(world, *object, t, [&](std::size_t i, const Vec3d& x) {
      p[i].set_xyz(Vec3f(plain ? x : x - Vec3d(particles.position[i].xyz())));
      if (jump) particles.start[i].set_xyz(p[i].xyz());  // it did not move there
    });
  }
}

}  // namespace souple
