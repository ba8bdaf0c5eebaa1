#pragma once

#include "souple/collision/surface.h"
#include "souple/math/vec3.h"

namespace souple {

/// Coulomb's law for sums over a substep: the tangential correction that would stop all sliding is allowed up
/// to mu_s times the normal correction; beyond, the surfaces slide and it is cut to mu_k times that.
/// Corrections and their limit in one unit, metres or metres per second.
inline Vec3f within_friction(const Vec3f& wanted, const SurfacePair& surface, float normal) {
  const float size = length(wanted);
  if (size <= surface.static_friction * normal) return wanted;
  return wanted * (surface.kinetic_friction * normal / size);
}

}  // namespace souple
