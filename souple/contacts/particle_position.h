#pragma once

#include "souple/solver/projector.h"

namespace souple {

/// Position of particle i in double: far from the origin no part of its displacement is lost. [m]
inline Vec3d particle_position(const ParticleView& particles, std::size_t i) {
  const Vec3d x(particles.position[i].xyz());
  return particles.form == Form::displacement ? x + Vec3d(particles.moving[i].xyz()) : x;
}

/// Position of particle i at the start of the substep. [m]
inline Vec3d particle_start_position(const ParticleView& particles, std::size_t i) {
  const Vec3d start(particles.start[i].xyz());
  return particles.form == Form::displacement ? Vec3d(particles.position[i].xyz()) + start : start;
}

}  // namespace souple
