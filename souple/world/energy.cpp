#include "souple/stages/energy.h"

#include "souple/solver/solver.h"
#include "souple/world/call_scope.h"
#include "souple/world/impl.h"
#include "souple/world/prepare.h"
#include "souple/world/world.h"

namespace souple {
namespace {

std::span<Projector* const> constraints_of(WorldState& world) {
  if (!world.current.running) bring_constraints_up_to_date(world);
  return world.constraints.lasting();
}

}  // namespace

double World::elastic_energy() const {
  WorldState& world = state();
  const CallScope call(*world.calls, "elastic_energy", From::stages);
  const std::span<Projector* const> constraints = constraints_of(world);
  return souple::elastic_energy(constraints, world.view());
}

double World::unconverged_energy(double dt) const {
  WorldState& world = state();
  const CallScope call(*world.calls, "unconverged_energy", From::stages);
  const std::span<Projector* const> constraints = constraints_of(world);
  return souple::unconverged_energy(constraints, world.view(), substep_of(world.settings, dt),
                                    *world.solving.solver);
}

}  // namespace souple
