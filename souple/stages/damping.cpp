#include "souple/stages/damping.h"

#include "souple/math/elementary.h"
#include "souple/objects/object.h"

#include <algorithm>

namespace souple {
namespace {

float damping_of(const Material& material) {
  return std::visit(
      [](const auto& m) {
        if constexpr (requires { m.damping; }) return m.damping;
        return 0.0f;
      },
      material);
}

// Sums are made of chunks of this many particles and combined in order: the same bits on any number of
// threads.
constexpr std::size_t chunk_size = 1024;

struct RigidMotion {
  Vec3d center, velocity, spin;
};

/// Sums over all particles that are not pinned, relative to `origin`. `of_chunk` is scratch.
RigidSums rigid_sums(const Particles& particles, const Object& object, const Vec3d& origin, Threads& threads,
                     std::vector<RigidSums>& of_chunk) {
  const std::size_t count = object.particle_count(), chunks = (count + chunk_size - 1) / chunk_size;
  of_chunk.resize(std::max(of_chunk.size(), chunks));
  threads.each(chunks, 1, [&](std::size_t chunk) {
    RigidSums sums;
    const std::size_t end = object.begin + std::min((chunk + 1) * chunk_size, count);
    for (std::size_t i = object.begin + chunk * chunk_size; i < end; ++i)
      if (particles.position[i].w != 0)
        sums.add(static_cast<double>(particles.mass[i]), Vec3d(particles.position[i].xyz()) - origin,
                 Vec3d(particles.velocity[i].xyz()));
    of_chunk[chunk] = sums;
  });
  RigidSums all;
  for (std::size_t chunk = 0; chunk < chunks; ++chunk) all.add(of_chunk[chunk]);
  return all;
}

// One pass: with r = x - c, c the center and V its velocity, sum m r x (v - V) = sum m x x v - M c x V. The origin is
// the position of a free particle. Then M |c|^2 is at most one particle's contribution to the trace, and the
// difference is far above a double's rounding.
RigidMotion rigid_motion(const Particles& particles, const Object& object, Threads& threads,
                         std::vector<RigidSums>& of_chunk) {
  const std::vector<Vec4f>& position = particles.position;
  std::size_t first = object.begin;
  while (first < object.end && position[first].w == 0) ++first;
  if (first == object.end) return {};
  const Vec3d origin(position[first].xyz());
  const RigidSums sums = rigid_sums(particles, object, origin, threads, of_chunk);
  const double M = sums.mass;
  if (!(M > 0)) return {};
  const Vec3d c = sums.position / M, V = sums.momentum / M;
  const Vec3d L = sums.angular - cross(c, V) * M;
  return {origin + c, V, spin_of(sums.inertia(), L)};
}

}  // namespace

void damp(const ObjectsView& objects, const Object& object, float h, Threads& threads,
          std::vector<RigidSums>& sums) {
  const float rate = damping_of(object.material);
  if (!(rate > 0) || object.traits().rolls) return;
  Particles& particles = objects.particles;
  const RigidMotion motion = rigid_motion(particles, object, threads, sums);
  const double k = 1 - elementary::exp(-static_cast<double>(rate) * static_cast<double>(h));
  threads.for_each(object.particle_count(), chunk_size, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = object.begin + begin; i < object.begin + end; ++i) {
      if (particles.position[i].w == 0) continue;
      const Vec3d r = Vec3d(particles.position[i].xyz()) - motion.center;
      const Vec3d v = Vec3d(particles.velocity[i].xyz());
      particles.velocity[i].set_xyz(Vec3f(v + (motion.velocity + cross(motion.spin, r) - v) * k));
    }
  });
}

}  // namespace souple
