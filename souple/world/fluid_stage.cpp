#include "souple/fluid/stage/fluid_input.h"
#include "souple/fluid/stage/fluids.h"
#include "souple/stages/forces.h"
#include "souple/stages/rigid_stage.h"
#include "souple/world/contact_state.h"
#include "souple/world/stages.h"

#include <utility>

// Connects a world to its fluids' stage (souple/fluid/stage/fluids.h).

namespace souple {

namespace {

FluidInput fluid_input(WorldState& world, double time) {
  return {.objects = world.objects_view(),
          .contacts = world.contact->tables,
          .emitters = world.flow.emitters,
          .settings = world.settings.fluid,
          .time = time,
          .threads = *world.threads,
          .warnings = world.warnings};
}

bool fluids_move(const WorldState& world) {
  return !world.fluids->none() && !world.current.first_non_finite;
}

}  // namespace

void build_fluids(WorldState& world) {
  world.fluids->build(world.objects_view());
}

void begin_fluids(WorldState& world, double dt) {
  world.fluids->begin_step(fluid_input(world, world.time), dt);
}

void solve_incompressibility(WorldState& world, const Substep& substep) {
  if (!fluids_move(world)) return;
  if (std::exchange(world.current.settles, false))
    world.fluids->settle(fluid_input(world, world.time), substep);
  world.fluids->solve_incompressibility(fluid_input(world, world.time), substep);
  world.rigid->gather(world.stage_view());
}

void update_fluid_velocities(WorldState& world, const Substep& substep) {
  if (!fluids_move(world)) return;
  const FluidAir air{wind_at(world.settings, world.time), world.settings.wind.air_density};
  world.fluids->update_velocities(fluid_input(world, world.time), air, substep);
}

void step_foam(WorldState& world, double time, double dt) {
  const FoamInput foam{.dt = dt,
                       .start_position = world.current.last_valid.position,
                       .start_offset = world.current.last_valid.offset,
                       .gravity = world.settings.gravity,
                       .seed = world.settings.seed * 0x9e3779b97f4a7c15u + world.steps};
  world.fluids->step_foam(fluid_input(world, time), foam);
}

}  // namespace souple
