#include "souple/world/fluid_stage.h"

#include "souple/fluid/stage/fluid_input.h"
#include "souple/fluid/stage/fluids.h"
#include "souple/fluid/stage/object_boundaries.h"
#include "souple/objects/fluid_boundary.h"
#include "souple/objects/object.h"
#include "souple/stages/forces.h"
#include "souple/world/contact_state.h"
#include "souple/world/flow.h"
#include "souple/world/stages.h"

#include <optional>
#include <utility>

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

/// Of fluids of the spacing of the last one: all have the same. Without fluids there are none.
ObjectBoundaries boundaries_of(const ObjectsView& view) {
  ObjectBoundaries result;
  float spacing = 0;
  for (const auto& object : view.objects)
    if (const auto* material = std::get_if<FluidMaterial>(&object->material)) spacing = material->spacing;
  for (std::uint32_t o = 0; spacing > 0 && o < view.objects.size(); ++o) {
    if (std::optional<BoundaryMesh> boundary = boundary_mesh_of(*view.objects[o], spacing)) {
      result.meshes.push_back(std::move(*boundary));
      result.with_mesh.push_back(o);
      continue;
    }
    const std::size_t before = result.bodies.size();
    append_sub_resolution_bodies(*view.objects[o], spacing, view.particles.mass,
                                 static_cast<std::uint32_t>(result.sub_resolution.size()), result.bodies);
    if (result.bodies.size() > before) result.sub_resolution.push_back(o);
  }
  return result;
}

}  // namespace

void build_fluids(WorldState& world) {
  world.fluids->set_boundaries(boundaries_of(world.objects_view()));
}

void begin_fluids(WorldState& world, double dt) {
  world.fluids->begin_step(fluid_input(world, world.time), dt);
}

void solve_incompressibility(WorldState& world, const Substep& substep) {
  if (fluids_move(world)) world.fluids->solve_incompressibility(fluid_input(world, world.time), substep);
}

void update_fluid_velocities(WorldState& world, const Substep& substep) {
  if (!fluids_move(world)) return;
  const FluidAir air{wind_at(world.settings, world.time), world.settings.wind.air_density};
  world.fluids->update_velocities(fluid_input(world, world.time), air, substep);
}

void step_foam(WorldState& world, double time, double dt) {
  const FoamInput foam{.dt = dt,
                       .start_position = world.last_valid.position,
                       .start_offset = world.last_valid.offset,
                       .gravity = world.settings.gravity,
                       .seed = world.settings.seed * 0x9e3779b97f4a7c15u + world.steps};
  world.fluids->step_foam(fluid_input(world, time), foam);
}

}  // namespace souple
