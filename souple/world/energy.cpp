#include "souple/stages/energy.h"

#include "souple/solver/solver.h"
#include "souple/world/impl.h"
#include "souple/world/prepare.h"
#include "souple/world/projectors.h"
#include "souple/world/world.h"

namespace souple {
namespace {

/// All projectors except contacts.
std::vector<const Projector*> constraints_of(WorldState& world) {
  if (!world.current.running) bring_constraints_up_to_date(world);
  std::vector<const Projector*> result;
  result.reserve(world.constraints.object_projectors.size() + world.constraints.users.size());
  for_each_constraint_projector(world, [&](const Projector& projector) { result.push_back(&projector); });
  return result;
}

}  // namespace

double World::elastic_energy() const {
  WorldState& world = impl_->state;
  const std::vector<const Projector*> constraints = constraints_of(world);
  return souple::elastic_energy(constraints, world.view());
}

double World::unconverged_energy(double dt) const {
  WorldState& world = impl_->state;
  const std::vector<const Projector*> constraints = constraints_of(world);
  return souple::unconverged_energy(constraints, world.view(), substep_of(world.settings, dt),
                                    *world.solving.solver);
}

}  // namespace souple
