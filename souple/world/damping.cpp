#include "souple/world/damping.h"

#include <cmath>

namespace souple {
namespace {

float damping_of(const Material& material) {
  return std::visit([](const auto& m) { return m.damping; }, material);
}

struct RigidMotion {
  Vec3d centre, velocity, spin;
};

RigidMotion rigid_motion(const Particles& particles, const Object& object) {
  double mass = 0;
  Vec3d centre, momentum;
  for (std::uint32_t i = object.begin; i < object.end; ++i) {
    if (particles.position[i].w == 0) continue;
    const auto m = static_cast<double>(particles.mass[i]);
    mass += m;
    centre += Vec3d(particles.position[i].xyz()) * m;
    momentum += Vec3d(particles.velocity[i].xyz()) * m;
  }
  if (!(mass > 0)) return {};
  RigidMotion motion{centre / mass, momentum / mass, {}};
  Vec3d L;
  Mat3d inertia;
  for (std::uint32_t i = object.begin; i < object.end; ++i) {
    if (particles.position[i].w == 0) continue;
    const auto m = static_cast<double>(particles.mass[i]);
    const Vec3d r = Vec3d(particles.position[i].xyz()) - motion.centre;
    L += cross(r, Vec3d(particles.velocity[i].xyz()) - motion.velocity) * m;
    inertia = inertia + (Mat3d::identity() * dot(r, r) - outer(r, r)) * m;
  }
  // A rod or a point has no inertia about its axis and no spin there: a little is added, relative to the
  // whole.
  const double t = trace(inertia);
  if (t > 0) motion.spin = inverse(inertia + Mat3d::identity() * (t * 1e-9)) * L;
  return motion;
}

}  // namespace

void damp(WorldState& world, const Object& object, float h) {
  const float rate = damping_of(object.material);
  if (!(rate > 0) || object.kind == ObjectKind::grains) return;
  Particles& particles = world.particles;
  const RigidMotion motion = rigid_motion(particles, object);
  const double k = -std::expm1(-static_cast<double>(rate) * static_cast<double>(h));
  for (std::uint32_t i = object.begin; i < object.end; ++i) {
    if (particles.position[i].w == 0) continue;
    const Vec3d r = Vec3d(particles.position[i].xyz()) - motion.centre;
    const Vec3d v = Vec3d(particles.velocity[i].xyz());
    particles.velocity[i].set_xyz(Vec3f(v + (motion.velocity + cross(motion.spin, r) - v) * k));
  }
}

}  // namespace souple
