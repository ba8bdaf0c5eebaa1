#pragma once

#include "souple/math/vec4.h"
#include "souple/objects/callbacks.h"
#include "souple/stages/callback_list.h"
#include "souple/stages/stage_view.h"

#include <span>
#include <vector>

namespace souple {

/// Wind velocity at time t [m/s]. Gusts vary it by a sum of sines, whose phases are a function of the seed:
/// every run has the same weather.
Vec3f wind_at(const Settings& settings, double t);

/// Forces of the wind on the triangles of cloths.
struct WindForces {
  std::vector<Vec4f> of_particle;  ///< [N]
  std::vector<Vec4f> of_triangle;  ///< of the current object: a third of the force [N]
};

/// Finds the wind's drag and lift for a substep of h seconds. Returns false, and finds nothing, without wind.
bool find_wind_forces(const StageView& stage, float h, WindForces& forces);

/// All that accelerates particles from outside.
struct ExternalForces {
  const StageView& stage;
  const CallbackList<VertexForceField>& fields;
  Vec3f wind;                                 ///< its velocity [m/s]
  std::span<const Vec4f> wind_of_particle{};  ///< [N]; empty without wind
};

/// External acceleration of particle i at position x and velocity v: gravity, linear drag, wind, force
/// fields. [m/s^2]
Vec3f acceleration(const ExternalForces& forces, std::size_t i, const Vec3f& x, const Vec3f& v, double t);

}  // namespace souple
