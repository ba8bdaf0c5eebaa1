#include "souple/world/prepare.h"

#include "souple/assert.h"
#include "souple/multilevel/make_solver.h"
#include "souple/world/build.h"
#include "souple/world/contacts.h"
#include "souple/world/sleeping.h"

namespace souple {

Substep substep_of(const Settings& settings, double dt) {
  const SolverKind solver = settings.solver.kind;
  const bool sweeps =
      solver == SolverKind::automatic || solver == SolverKind::gauss_seidel || solver == SolverKind::jacobi;
  return {.h = static_cast<float>(dt / settings.substeps),
          .iterations = settings.iterations,
          .mode = settings.mode,
          .form = settings.form,
          .count = settings.substeps,
          .relaxation = sweeps ? settings.solver.relaxation : 1};
}

namespace {

/// Positions with the inverse masses that particles have while awake: what a solver prepares for them stays
/// valid when objects fall asleep and wake up.
std::vector<Vec4f> awake_positions(const WorldState& world) {
  const Particles& particles = world.particles;
  std::vector<Vec4f> result(particles.position.begin(), particles.position.end());
  for (const auto& pointer : world.objects) {
    const Object& object = *pointer;
    if (object.island == 0) continue;
    for (std::uint32_t i = object.begin; i < object.end; ++i)
      result[i].w = particles.mass[i] > 0 ? 1 / particles.mass[i] : 0;
    for (const PinnedParticle& pin : object.pins) result[object.begin + pin.particle].w = 0;
  }
  return result;
}

}  // namespace

namespace {

bool ranges_are_contiguous(const WorldState& world) {
  std::uint32_t begin = 0;
  for (const auto& object : world.objects) {
    if (object->begin != begin || object->end > object->reserved_end()) return false;
    if (object->end - object->begin != object->particle_count()) return false;
    begin = object->reserved_end();
  }
  return begin == world.particles.size();
}

}  // namespace

void bring_constraints_up_to_date(WorldState& world) {
  if (world.dirty_objects) world.particles.shrink_to_fit(), world.object_of.shrink_to_fit();
  if (world.dirty_objects || world.dirty_radii) build_contact_radii(world);
  const bool changed = world.dirty_constraints || world.dirty_groups;
  const bool rebuilt = changed && build_constraints(world);
  world.dirty_solver = world.dirty_solver || changed;
  world.dirty_constraints = world.dirty_objects = world.dirty_radii = false;
  world.for_each_constraint_projector(
      [&](Projector& projector) { projector.prepare(world.particles.size()); });
  if (rebuilt) world.balance.choose(world), world.report.objects.clear();
  if (!world.threads)
    world.threads = world.jobs ? make_threads(*world.jobs)
                               : make_threads(world.settings.threading, world.settings.threads);
  if (!world.dirty_solver && !world.dirty_masses) return;
  world.order.clear();
  world.for_each_projector([&](Projector& projector) { world.order.push_back(&projector); });
  for (Projector* projector : world.order) projector->split(0, 0);  // undo splits of the last solver
  const std::vector<Vec4f> awake = awake_positions(world);
  ParticleView view = world.view();
  view.position = awake;
  for (Projector* projector : world.order) projector->prepare_sweeps(view, world.dirty_masses);
  if (!world.solver || !(world.solver_settings == world.settings.solver)) {
    world.solver = make_solver(world.settings.solver);
    world.solver_settings = world.settings.solver;
  }
  world.solver->prepare(world.order, view, *world.threads);
  world.dirty_solver = world.dirty_masses = false;
}

void bring_up_to_date(WorldState& world) {
  SOUPLE_ASSERT(ranges_are_contiguous(world), "objects divide the particles in order");
  bring_constraints_up_to_date(world);
  if (!world.dirty_tables) return;
  build_contact_tables(world);
  world.dirty_tables = false;
}

namespace {

// Whether a distance joint is active follows from the time alone, so a restored world reactivates its joints.
// Time is a sum of steps: a billionth of a second too little must not delay the release by a step.
void release_joints(WorldState& world) {
  constexpr double rounding = 1e-9;  // s
  for (UserConstraint& user_constraint : world.user_constraints) {
    const bool is_active = !user_constraint.until || world.time + rounding < *user_constraint.until;
    if (is_active == user_constraint.is_active) continue;
    user_constraint.is_active = is_active;
    world.dirty_tables = world.dirty_solver = true;  // contacts exclude joined particles
    wake_particles_of(world, *user_constraint.projector);
  }
}

}  // namespace

bool prepare_step(WorldState& world) {
  try {
    release_joints(world);
    bring_up_to_date(world);
    return true;
  } catch (const Error& error) {
    world.warn(Flag::callback_failed, std::string(error.what()) + "; nothing was done");
    return false;
  }
}

}  // namespace souple
