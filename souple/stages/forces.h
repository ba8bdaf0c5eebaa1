#pragma once

#include "souple/math/vec4.h"
#include "souple/objects/callbacks.h"
#include "souple/stages/callback_list.h"
#include "souple/stages/stage_view.h"

#include <vector>

namespace souple {

/// Wind velocity at time t [m/s]. Gusts vary it by a sum of sines, whose phases are a function of the seed:
/// every run has the same weather.
Vec3f wind_at(const Settings& settings, double t);

/// True for a cloth that is awake and has a drag or lift coefficient, where there is air: still air resists too.
bool feels_air(const Object& object, const Wind& air);

/// Finds the drag and lift of the air for a substep of h seconds, on the particles of each object that feels_air. The force
/// [N] waits in Particles::start, which the prediction reads and then overwrites. `thirds`: scratch.
void find_air_forces(const StageView& stage, float h, std::vector<Vec4f>& thirds);

/// All that accelerates particles from outside.
struct ExternalForces {
  const StageView& stage;
  const CallbackList<VertexForceField>& fields;
  Vec3f wind;  ///< its velocity [m/s]
};

/// External acceleration of particle i at position x and velocity v: gravity, linear drag, the air's force that waits in
/// Particles::start, force fields. [m/s^2]
Vec3f acceleration(const ExternalForces& forces, std::size_t i, const Vec3f& x, const Vec3f& v, double t);

}  // namespace souple
