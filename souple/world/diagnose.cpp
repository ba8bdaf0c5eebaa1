#include "souple/world/diagnose.h"

#include "souple/assert.h"
#include "souple/constraints/neo_hookean.h"
#include "souple/multilevel/make_solver.h"
#include "souple/world/build.h"
#include "souple/world/contacts.h"
#include "souple/world/sleeping.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <iterator>

#include <fmt/format.h>

namespace souple {
namespace {

constexpr double large_strain = 0.1;
constexpr double max_fluid_step = 0.36;  // a third, and a tolerance for waves on a fluid at rest

void restore_last_valid(WorldState& world) {
  Particles& particles = world.particles;
  const std::size_t particle = *world.first_non_finite;
  const Object& object = *world.objects[world.object_of[particle]];
  world.report.bad_object = object.name;
  world.report.bad_vertex = object.vertex_of[particle - object.begin];
  particles.position = world.last_valid_position;
  particles.offset = world.last_valid_offset;
  particles.velocity = world.last_valid_velocity;
  particles.spin = world.last_valid_spin;
  update_sleeping_masses(world);
  world.warn(Flag::non_finite, fmt::format("{}, vertex {}: {}", object.name, world.report.bad_vertex,
                                           advice(Flag::non_finite)));
}

void measure(WorldState& world) {
  StepReport& report = world.report;
  const ParticleView view = world.view();
  world.for_each_projector([&](Projector& projector) {
    if (projector.size() == 0) return;
    report.constraints += projector.size();
    KindReport kind{.kind = projector.kind(), .count = projector.size()};
    if (world.settings.measure_residuals) {
      const Residual residual = projector.measure(view, *world.threads);
      kind.largest = residual.largest;
      kind.mean = residual.count > 0 ? residual.sum / static_cast<double>(residual.count) : 0;
      kind.largest_strain = residual.largest_strain;
      report.largest_strain = std::max(report.largest_strain, residual.largest_strain);
    }
    report.kinds.push_back(kind);
  });
}

// Reports exceptions and non-finite results of users' run-time constraints.
void report_custom_errors(WorldState& world) {
  for (const UserConstraint& user_constraint : world.user_constraints)
    if (auto* custom = dynamic_cast<CustomProjector*>(user_constraint.projector.get())) {
      const std::string error = custom->take_error();
      if (!error.empty()) world.warn(Flag::callback_failed, error);
    }
}

void report_fluids(WorldState& world) {
  const FluidReport flow = world.report.fluid;
  FluidReport& report = world.report.fluid = world.fluids.report();
  report.emitted = flow.emitted, report.drained = flow.drained, report.held_back = flow.held_back;
}

void flag_not_converged(WorldState& world) {
  const ObjectReport* worst = world.balance.worst(world);
  if (worst == nullptr) return;
  fmt::memory_buffer line;  // a string would allocate
  fmt::format_to(std::back_inserter(line), "{}: {}", worst->name, advice(Flag::not_converged));
  world.warn(Flag::not_converged, {line.data(), line.size()});
}

/// Where the solver has converged, the material itself is as soft as that.
std::string_view strain_advice(const WorldState& world) {
  constexpr double converged = 0.01;  // of the stretch that would restore the balance
  const std::vector<ObjectReport>& objects = world.report.objects;
  if (objects.empty() || std::any_of(objects.begin(), objects.end(),
                                     [](const ObjectReport& o) { return o.stretch > converged; }))
    return advice(Flag::large_strain);
  return "an edge or a membrane is stretched by more than 10 %, as its stiffness allows: raise the "
         "stiffness, or "
         "lower the load";
}

void raise_flags(WorldState& world) {
  const StepReport& report = world.report;
  flag_not_converged(world);
  if (std::any_of(report.kinds.begin(), report.kinds.end(), [](const KindReport& kind) {
        return kind.kind != NeoHookean::name && kind.largest_strain > large_strain;
      }))
    world.warn(Flag::large_strain, strain_advice(world));
  if (report.fluid.largest_step > max_fluid_step)
    world.warn(Flag::coarse_substeps, advice(Flag::coarse_substeps));
  if (!(report.deepest_contact > 0)) return;
  float thickest = 0;
  for (const float radius : world.particles.radius) thickest = std::max(thickest, radius);
  if (report.deepest_contact > 2 * static_cast<double>(thickest))
    world.warn(Flag::deep_contact, advice(Flag::deep_contact));
}

}  // namespace

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

bool begin_step(WorldState& world, double dt) {
  StepReport& report = world.report;
  if (world.stepping) {
    world.warn(Flag::callback_failed, "step: a callback called step during a step; nothing was done");
    return false;
  }
  std::swap(world.warned_before, world.warned);
  world.warned.clear();
  std::vector<KindReport> kinds = std::move(report.kinds);
  std::vector<ObjectReport> objects = std::move(report.objects);
  kinds.clear();
  report = {};
  report.kinds = std::move(kinds);
  report.objects = std::move(objects);
  report.step = world.steps;
  report.time = world.time;
  if (!(dt > 0) || !std::isfinite(dt) || !(static_cast<float>(dt / world.settings.substeps) > 0)) {
    report.message = fmt::format("step: dt is {} s, expected a positive finite time; nothing was done", dt);
    return false;
  }
  try {
    release_joints(world);
    bring_up_to_date(world);
  } catch (const Error& error) {
    world.warn(Flag::callback_failed, std::string(error.what()) + "; nothing was done");
    return false;
  }
  world.invalidate_contacts();
  begin_arrivals(world, dt);
  update_flow(world, dt);
  update_fluid_counts(world);
  world.fluids.begin_step(world, dt);
  world.first_non_finite.reset();
  report.step = ++world.steps;
  report.substeps = world.settings.substeps;
  report.iterations = world.settings.iterations;
  for (const auto& object : world.objects) report.particles += object->particle_count();
  return true;
}

void save_last_valid(WorldState& world) {
  const Particles& particles = world.particles;
  const auto keep = [&world](const std::vector<Vec4f>& array, std::vector<Vec4f>& valid) {
    valid.resize(array.size());
    world.threads->for_each(array.size(), 8192, [&](std::size_t begin, std::size_t end) {
      std::memcpy(&valid[begin], &array[begin], (end - begin) * sizeof(Vec4f));
    });
  };
  keep(particles.position, world.last_valid_position);
  keep(particles.offset, world.last_valid_offset);
  keep(particles.velocity, world.last_valid_velocity);
  keep(particles.spin, world.last_valid_spin);
  SOUPLE_ASSERT(world.last_valid_offset.size() == particles.size(), "arrays of particles have one length");
}

void end_step(WorldState& world, bool valid) {
  if (!valid) restore_last_valid(world);
  end_arrivals(world, valid);
  ++world.version;
  world.contacts_valid = true;
  world.report.time = world.time;
  report_contacts(world);
  report_fluids(world);
  report_custom_errors(world);
  measure(world);
  if (valid) raise_flags(world);
}

void run_callbacks(World& self, WorldState& world,
                   const std::vector<std::function<void(World&)>>& callbacks) {
  for (const auto& callback : callbacks) world.guarded("a stage's callback", [&] { callback(self); });
}

}  // namespace souple
