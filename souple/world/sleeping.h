#pragma once

#include "souple/stages/sleeping.h"

// Sleeping of a world's objects: stages/sleeping.h.

namespace souple {

struct WorldState;

void wake_disturbed(WorldState& world, double dt);
void fall_asleep(WorldState& world, double dt);

void wake_island(WorldState& world, const Object& object);
void wake_all(WorldState& world);
void wake_particles_of(WorldState& world, const Projector& projector);

void update_sleeping_masses(WorldState& world);

}  // namespace souple
