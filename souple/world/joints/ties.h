#pragma once

#include "souple/world/state.h"

#include <functional>

// Ties of any two objects. stages/ties.h solves them.

namespace souple {

struct JoinedObjects;
struct TieEnd;

/// Brings the indices of tied bodies and particles up to date.
void list_ties(WorldState& world);
/// Moves the sides of ties that colliders hold to where these are at time t [s].
void drive_ties(WorldState& world, double t);
/// Adds the objects that ties hold together.
void list_tied(const WorldState& world, JoinedObjects& joined);
/// Removes the ties with an end of which `holds` is true.
void remove_ties_if(WorldState& world, const std::function<bool(const TieEnd&)>& holds);
/// After a step: counts ties that broke, and logs them.
void report_ties(WorldState& world);

}  // namespace souple
