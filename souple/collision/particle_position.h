#pragma once

#include "souple/solver/projector.h"

namespace souple {

/// Where particle i is, in double: nothing of its displacement is lost far from the origin. [m]
inline Vec3d particle_position(const ParticleView& particles, std::size_t i) {
  const Vec3d x(particles.position[i].xyz());
  return particles.form == Form::displacement ? x + Vec3d(particles.moving[i].xyz()) : x;
}

/// Where it was when the substep began. [m]
inline Vec3d particle_start_position(const ParticleView& particles, std::size_t i) {
  const Vec3d start(particles.start[i].xyz());
  return particles.form == Form::displacement ? Vec3d(particles.position[i].xyz()) + start : start;
}

}  // namespace souple
