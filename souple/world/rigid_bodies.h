#pragma once

#include "souple/math/transform.h"
#include "souple/math/vec3.h"

namespace souple {

struct Object;
struct ObstacleMotion;
struct WorldState;

/// Throw Error, in the name of the function `what`: if the object is a kinematic body; if it is one that follows a motion.
void require_dynamic(const Object& object, const char* what);
void require_no_motion(const Object& object, const char* what);

/// World::set_motion of a rigid body.
void set_body_motion(WorldState& world, Object& object, ObstacleMotion motion);
/// Moves the body of an object whose particles are teleported.
void teleport_body(WorldState& world, const Object& object, const Transform& transform);

/// Sums over a rigid body; a kinematic one has no mass. [J], [kg m/s]
double kinetic_energy_of_body(const WorldState& world, const Object& object);
double potential_energy_of_body(const WorldState& world, const Object& object);
Vec3d momentum_of_body(const WorldState& world, const Object& object);

}  // namespace souple
