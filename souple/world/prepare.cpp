#include "souple/world/prepare.h"

#include "souple/assert.h"
#include "souple/error.h"
#include "souple/objects/object.h"
#include "souple/solver/facets.h"
#include "souple/stages/rigid_joints.h"
#include "souple/stages/rigid_stage.h"
#include "souple/stages/sleeping.h"
#include "souple/stages/ties.h"
#include "souple/stages/user_constraint.h"
#include "souple/studies/make_solver.h"
#include "souple/world/build.h"
#include "souple/world/call_scope.h"
#include "souple/world/contact_state.h"
#include "souple/world/contacts.h"
#include "souple/world/joints/ties.h"
#include "souple/world/sleeping.h"
#include "souple/world/step_report.h"
#include "souple/world/step_scratch.h"

#include <algorithm>

namespace souple {

Substep substep_of(const Settings& settings, double dt) {
  const SolverKind solver = settings.solver.kind;
  const bool sweeps =
      solver == SolverKind::automatic || solver == SolverKind::gauss_seidel || solver == SolverKind::jacobi;
  return {.h = static_cast<float>(dt / settings.substeps),
          .iterations = settings.iterations,
          .mode = settings.mode,
          .count = settings.substeps,
          .relaxation = sweeps ? settings.solver.relaxation : 1};
}

namespace {

/// Positions with the inverse masses that awake particles show to the solver. The solver's preparation then stays valid
/// when objects fall asleep and wake up.
std::vector<Vec4f> awake_positions(const WorldState& world) {
  const Particles& particles = world.particles;
  std::vector<Vec4f> result(particles.position.begin(), particles.position.end());
  for (const auto& pointer : world.objects) {
    const Object& object = *pointer;
    if (object.sleep.island == 0) continue;
    for (std::uint32_t i = object.begin; i < object.end; ++i)
      result[i].w = particles.mass[i] > 0 ? 1 / particles.mass[i] : 0;
    for (const PinnedParticle& pin : object.pins) result[object.begin + pin.particle].w = 0;
  }
  world.constraints.ties->add_loads(result);
  return result;
}

bool ranges_are_contiguous(const WorldState& world) {
  std::uint32_t begin = 0;
  for (const auto& object : world.objects) {
    if (object->begin != begin || object->end > object->reserved_end()) return false;
    if (object->end - object->begin != object->particle_count()) return false;
    begin = object->reserved_end();
  }
  return begin == world.particles.size();
}

/// Calls f(projector) for all projectors except contacts, in order of solution: objects' constraints, user constraints.
template <class Function>
void for_each_lasting(const WorldState& world, const Function& f) {
  for (Projector* const projector : world.constraints.object_projectors) f(*projector);
  for (const UserConstraint& user_constraint : world.constraints.users)
    if (user_constraint.is_active) f(*user_constraint.projector);
  if (!world.constraints.ties->empty()) f(*world.constraints.ties);
}

/// Regions that constraints other than contacts connect.
void prepare_regions(WorldState& world) {
  std::vector<IndexRange> objects;
  for (const auto& object : world.objects) objects.push_back({object->begin, object->reserved_end()});
  std::vector<SweepRegions::ObjectPair> joined;
  const ParticleView view = world.view();
  const auto join = [&](const ConstraintState& constraint) {
    for (const std::uint32_t i : constraint.particles)
      joined.emplace_back(world.object_of[constraint.particles.front()], world.object_of[i]);
  };
  for (const UserConstraint& user_constraint : world.constraints.users)
    if (user_constraint.is_active) user_constraint.projector->visit(view, join);
  world.constraints.ties->visit(view, join);
  std::sort(joined.begin(), joined.end());
  joined.erase(std::unique(joined.begin(), joined.end()), joined.end());
  world.scratch->regions.set_objects(objects, std::move(joined));
}

void order_projectors(WorldState& world) {
  std::vector<Projector*>& order = world.constraints.order;
  order.clear();
  for_each_lasting(world, [&](Projector& projector) { order.push_back(&projector); });
  world.constraints.without_contacts = order.size();
  for (const auto& kind : world.contact->contacts.kinds()) order.push_back(kind.get());
}

/// Calls build(). Its exceptions other than Error leave half of what it builds.
template <class Function>
void or_broken(WorldState& world, const Function& build) {
  try {
    build();
  } catch (const Error&) {
    throw;
  } catch (...) {
    world.calls->broken = true;
    throw;
  }
}

void build_constraints_and_solver(WorldState& world) {
  if (world.dirty.objects) world.particles.shrink_to_fit(), world.object_of.shrink_to_fit();
  if (world.dirty.objects || world.dirty.radii) build_contact_radii(world);
  const bool changed = world.dirty.constraints || world.dirty.groups;
  const bool rebuilt = changed && build_constraints(world);
  world.dirty.solver = world.dirty.solver || changed;
  world.dirty.constraints = world.dirty.objects = world.dirty.radii = false;
  for_each_lasting(world, [&](Projector& projector) { projector.prepare(world.particles.size()); });
  if (rebuilt) {
    world.scratch->balance.choose(world.objects_view(), world.constraints.object_projectors);
    world.report.objects.clear();
  }
  if (!world.threads)
    world.threads = world.jobs ? make_threads(*world.jobs)
                               : make_threads(world.settings.threading, world.settings.threads);
  if (!world.dirty.solver && !world.dirty.masses) return;
  order_projectors(world);
  prepare_regions(world);
  world.scratch->sleep->changed = true;
  for (Projector* projector : world.constraints.order)
    if (StudyFacet* const study = projector->facets().study)
      study->restore();  // what the last solver replaced
  const std::vector<Vec4f> awake = awake_positions(world);
  ParticleView view = world.view();
  view.position = awake;
  for (Projector* projector : world.constraints.order)
    if (ElasticFacet* const elastic = projector->facets().elastic)
      elastic->prepare_sweeps(view, world.dirty.masses);
  if (!world.solving.solver || !(world.solving.settings == world.settings.solver)) {
    world.solving.solver = make_solver(world.settings.solver);
    world.solving.settings = world.settings.solver;
  }
  world.solving.solver->prepare(world.constraints.order, view, *world.threads);
  world.scratch->angular_momentum.forget();
  world.dirty.solver = world.dirty.masses = false;
}

}  // namespace

void bring_constraints_up_to_date(WorldState& world) {
  require_whole(*world.calls, "preparing a step");
  list_ties(world);
  or_broken(world, [&] { build_constraints_and_solver(world); });
}

void bring_up_to_date(WorldState& world) {
  SOUPLE_ASSERT(ranges_are_contiguous(world), "objects divide the particles in order");
  bring_constraints_up_to_date(world);
  if (!world.dirty.tables) return;
  or_broken(world, [&] { build_contact_tables(world); });
  world.dirty.tables = false;
}

namespace {

/// First particle of the object of a tie's or joint's side.
std::uint32_t particle_of(const WorldState& world, const ObjectId* object, std::uint32_t particle) {
  return object ? world.object(*object).begin + particle : AngularMomentum::fixed;
}

void add_link(AngularMomentum::Links& links, std::uint32_t a, std::uint32_t b) {
  if (a != AngularMomentum::fixed || b != AngularMomentum::fixed)
    links.emplace_back(std::min(a, b), std::max(a, b));
}

// Ties and joints that break, and constraints that change, connect other particles.
void find_groups(WorldState& world) {
  AngularMomentum::Links& links = world.scratch->links;
  links.clear();
  const RigidJoints& joints = world.rigid->joints();
  for (std::size_t j = 0; j < joints.records().size(); ++j)
    if (!joints.joints().state[j].broken)
      add_link(links, particle_of(world, joints.records()[j].a.object(), 0),
               particle_of(world, joints.records()[j].b.object(), 0));
  const auto end = [&](const TieEnd& side) {
    return particle_of(world, side.object ? &*side.object : nullptr,
                       side.parts.empty() ? 0 : side.parts.front().particle);
  };
  const Ties& ties = *world.constraints.ties;
  for (std::size_t k = 0; k < ties.count(); ++k)
    if (ties.state(k).broken == 0) add_link(links, end(ties.tie(k).a), end(ties.tie(k).b));
  if (!world.scratch->angular_momentum.knows(links))
    world.scratch->angular_momentum.find(
        world.objects_view(),
        world.constraints.lasting().first(world.constraints.without_contacts - (ties.empty() ? 0 : 1)),
        world.constraints.users, links);
}

// Whether a distance joint is active follows from the time alone, so a restored world reactivates its joints.
// Time is a sum of steps: a billionth of a second too little must not delay the release by a step.
void release_joints(WorldState& world) {
  constexpr double rounding = 1e-9;  // s
  for (UserConstraint& user_constraint : world.constraints.users) {
    const bool is_active = !user_constraint.until || world.time + rounding < *user_constraint.until;
    if (is_active == user_constraint.is_active) continue;
    user_constraint.is_active = is_active;
    world.dirty.tables = world.dirty.solver = true;  // contacts exclude joined particles
    wake_particles_of(world, *user_constraint.projector);
  }
}

}  // namespace

bool prepare_step(WorldState& world, double dt) {
  try {
    release_joints(world);
    world.constraints.ties->begin_step(dt / world.settings.substeps);
    bring_up_to_date(world);
    find_groups(world);
    return true;
  } catch (const Error& error) {
    refuse_step(world, error.what());
    return false;
  }
}

}  // namespace souple
