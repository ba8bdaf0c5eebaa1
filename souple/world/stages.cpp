#include "souple/world/stages.h"

#include "souple/assert.h"
#include "souple/objects/object.h"
#include "souple/solver/facets.h"
#include "souple/solver/solver.h"
#include "souple/stages/damping.h"
#include "souple/stages/motion.h"
#include "souple/stages/obstacles.h"
#include "souple/stages/pins.h"
#include "souple/stages/rigid_stage.h"
#include "souple/stages/sleeping.h"
#include "souple/stages/spin.h"
#include "souple/stages/ties.h"
#include "souple/stages/user_constraint.h"
#include "souple/studies/integrators.h"
#include "souple/world/callbacks.h"
#include "souple/world/contact_state.h"
#include "souple/world/contacts.h"
#include "souple/world/joints/ties.h"
#include "souple/world/sleeping.h"
#include "souple/world/step_report.h"
#include "souple/world/step_scratch.h"

#include <algorithm>

namespace souple {
namespace {

void note(WorldState& world, std::optional<std::size_t> first_non_finite) {
  if (first_non_finite && !world.current.first_non_finite) world.current.first_non_finite = first_non_finite;
}

/// Part of the step that has passed at the end of the substep.
double part_of_step(const WorldState& world, const Substep& substep) {
  if (world.current.last_substep) return 1;
  return (world.time + static_cast<double>(substep.h) - world.current.start) / world.current.length;
}

// Kelvin-Voigt damping of the constraints, on the velocities of the substep. PBD mode has none.
void damp_constraints(WorldState& world, const Substep& substep) {
  if (world.scratch->sleep->all || substep.mode == Mode::pbd) return;
  const ParticleView view = world.view();
  const std::span<Vec4f> velocity = world.particles.velocity;
  for (Projector* const projector : world.constraints.order)
    if (ElasticFacet* const elastic = projector->facets().elastic)
      elastic->damp(view, velocity, substep, *world.threads);
}

// Stiffnesses of PBD are no forces, and phantoms no particles.
bool measures_balance(const WorldState& world) {
  const Settings& settings = world.settings;
  return world.current.last_substep && settings.measure_residuals && settings.mode != Mode::pbd &&
         settings.solver.colors == 0;
}

/// Particles of the objects that intersections are being removed from, and of those whose tie broke in this step. For the
/// latter the solver was prepared with other masses.
std::span<const IndexRange> find_without_levels(WorldState& world) {
  std::vector<IndexRange>& ranges = world.scratch->without_levels;
  ranges.clear();
  const auto add = [&](const Object& object) {
    if (ranges.empty() || ranges.back().begin != object.begin) ranges.push_back({object.begin, object.end});
  };
  world.contact->contacts.visit_separated(
      [&](std::uint32_t particle) { add(*world.objects[world.object_of[particle]]); });
  const Ties& ties = *world.constraints.ties;
  for (const std::uint32_t k : ties.broken())
    for (const TieEnd* const end : {&ties.tie(k).a, &ties.tie(k).b})
      if (end->object) add(world.object(*end->object));
  const auto before = [](const IndexRange& a, const IndexRange& b) { return a.begin < b.begin; };
  std::sort(ranges.begin(), ranges.end(), before);
  const auto same = [](const IndexRange& a, const IndexRange& b) { return a.begin == b.begin; };
  ranges.erase(std::unique(ranges.begin(), ranges.end(), same), ranges.end());
  return ranges;
}

}  // namespace

void integrate(WorldState& world, const Substep& substep) {
  if (world.scratch->sleep->woken) find_candidates(world, static_cast<double>(substep.h) * substep.count);
  if (world.scratch->sleep->rests()) return;
  const StageView stage = world.stage_view();
  world.scratch->motion.integrate = integrate_by(world.settings.integrator);
  note(world, predict_motion(stage, world.callbacks->force_fields, substep, world.scratch->motion));
  predict_spin(stage.objects, substep, stage.threads);
  drive_pins(stage, substep, part_of_step(world, substep));
  if (drive_obstacles(stage, substep)) world.contact->check_intersections = true;
  world.rigid->predict(stage, substep);
  drive_ties(world, stage.time + static_cast<double>(substep.h));
  drive_attachments(world.constraints.users, stage.time + static_cast<double>(substep.h), stage.warnings);
  keep_prediction(stage, world.scratch->motion);
}

// Other integrators are there for comparison: they leave p* and v* that do not belong together.
void begin_angular_momentum(WorldState& world) {
  AngularMomentum& angular_momentum = world.scratch->angular_momentum;
  if (integrate_by(world.settings.integrator) == nullptr)
    angular_momentum.begin_step(world.stage_view(), *world.rigid);
  else
    angular_momentum.leave_all();
}

void solve(WorldState& world, const Substep& substep) {
  if (world.scratch->sleep->all) return;
  SOUPLE_ASSERT(!world.dirty.solver && !world.dirty.constraints, "a step prepares its solver");
  const ParticleView view = world.view();
  for (Projector* const projector : world.constraints.order) projector->begin_substep(view, substep);
  const auto h = static_cast<double>(substep.h);
  AngularMomentum& angular_momentum = world.scratch->angular_momentum;
  world.rigid->gather(world.stage_view());
  angular_momentum.begin_solve(world.stage_view(), *world.rigid, h);
  world.rigid->begin_ties(world.stage_view(), substep, *world.constraints.ties);
  Substep solved = substep;
  solved.without_levels = find_without_levels(world);
  world.scratch->regions.begin_substep();
  solved.regions = &world.scratch->regions;
  SleepScratch& sleep = *world.scratch->sleep;
  leave_out_asleep(world.objects_view(), world.constraints.object_projectors, sleep);
  if (!sleep.constraints.empty()) solved.asleep = &sleep.constraints;
  if (measures_balance(world)) {
    solved.external = &world.scratch->balance.external();
    world.scratch->balance.begin(world.steps, view);
    world.solving.solver->solve(world.constraints.order, view, solved, *world.threads);
    world.scratch->balance.measure(world.objects_view(), length(Vec3d(world.settings.gravity)), substep);
    report_balance(world);
  } else {
    world.solving.solver->solve(world.constraints.order, view, solved, *world.threads);
    if (world.current.last_substep) world.report.objects.clear();
  }
  world.rigid->solve(world.stage_view(), substep, world.contact->contacts, *world.constraints.ties);
  angular_momentum.end_solve(world.stage_view(), *world.rigid, world.contact->contacts, h);
  keep_apart(world, substep);
}

bool finish(WorldState& world, const Substep& substep) {
  if (world.scratch->sleep->rests()) return true;
  note(world, finish_motion(world.stage_view(), substep, world.scratch->motion));
  world.rigid->finish(world.stage_view(), substep, world.contact->contacts);
  world.scratch->angular_momentum.finish(world.stage_view(), *world.rigid);
  ++world.version;
  return !world.current.first_non_finite;
}

bool update_velocities(WorldState& world, const Substep& substep) {
  if (world.scratch->sleep->rests()) return true;
  apply_restitution(world, substep);
  const ObjectsView objects = world.objects_view();
  finish_spin(objects, substep, *world.threads);
  damp_constraints(world, substep);
  update_fluid_velocities(world, substep);
  for (const auto& object : world.objects)
    if (object->sleep.island == 0)
      damp(objects, *object, substep.h, *world.threads, world.scratch->rigid_sums);
  world.rigid->gather_velocities(world.stage_view());
  if (world.current.last_substep) note(world, find_non_finite(world.stage_view()));
  return !world.current.first_non_finite;
}

}  // namespace souple
