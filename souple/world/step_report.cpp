#include "souple/world/step_report.h"

#include "souple/assert.h"
#include "souple/constraints/neo_hookean.h"
#include "souple/fluid/stage/fluids.h"
#include "souple/math/limits.h"
#include "souple/objects/collider_record.h"
#include "souple/objects/object.h"
#include "souple/objects/obstacle_pose.h"
#include "souple/solver/facets.h"
#include "souple/stages/motion.h"
#include "souple/stages/rigid_stage.h"
#include "souple/stages/ties.h"
#include "souple/stages/user_constraint.h"
#include "souple/world/call_scope.h"
#include "souple/world/joints/joints.h"
#include "souple/world/joints/ties.h"
#include "souple/world/sleeping.h"
#include "souple/world/step_scratch.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <iterator>

#include <fmt/format.h>

namespace souple {
namespace {

constexpr double large_strain = 0.1;
constexpr double max_fluid_step = 0.36;  // a third, and a tolerance for waves on a fluid at rest

void measure(WorldState& world) {
  StepReport& report = world.report;
  const ParticleView view = world.view();
  for (Projector* const projector : world.constraints.order) {
    if (projector->size() == 0) continue;
    report.constraints += projector->size();
    KindReport kind{.kind = projector->kind(), .count = projector->size()};
    if (world.settings.measure_residuals) {
      const Residual residual = projector->residual(view, world.threads.get());
      kind.largest = residual.largest;
      kind.mean = residual.count > 0 ? residual.sum / static_cast<double>(residual.count) : 0;
      kind.largest_strain = residual.largest_strain;
      report.largest_strain = std::max(report.largest_strain, residual.largest_strain);
    }
    report.kinds.push_back(kind);
  }
}

// Reports exceptions and non-finite results of users' run-time constraints.
void report_custom_errors(WorldState& world) {
  for (const UserConstraint& user_constraint : world.constraints.users)
    if (ErrorFacet* const errors = user_constraint.projector->facets().errors) {
      const std::string error = errors->take_error();
      if (!error.empty()) world.warnings.warn(Flag::callback_failed, error);
    }
}

void report_fluids(WorldState& world) {
  const FluidReport flow = world.report.fluid;
  FluidReport& report = world.report.fluid = world.fluids->report();
  report.emitted = flow.emitted, report.drained = flow.drained, report.held_back = flow.held_back;
}

void flag_not_converged(WorldState& world) {
  if (world.report.objects.empty()) return;
  const std::optional<std::size_t> worst = world.scratch->balance.worst(world.objects_view());
  if (!worst) return;
  fmt::memory_buffer line;  // a string would allocate
  fmt::format_to(std::back_inserter(line), "{}: {}", world.report.objects[*worst].name,
                 advice(Flag::not_converged));
  world.warnings.warn(Flag::not_converged, {line.data(), line.size()});
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

void flag_out_of_range(WorldState& world) {
  const std::optional<std::size_t> particle = find_out_of_range(world.objects_view(), *world.threads);
  if (!particle) return;
  const Object& object = *world.objects[world.object_of[*particle]];
  const Vec3f x = world.particles.position[*particle].xyz();
  world.warnings.warn(
      Flag::out_of_range,
      fmt::format("{}, vertex {} is {:.3g} m from the origin, at {:.3g} m/s; floats are 64 m apart beyond "
                  "{:g} m, and "
                  "contacts may be missed: check its speed and the forces on it, or remove it",
                  object.name, object.vertex_of[*particle - object.begin], length(Vec3d(x)),
                  length(Vec3d(world.particles.velocity[*particle].xyz())), range::coordinate));
}

void flag_jumps(WorldState& world) {
  const auto warn = [&](const std::string& name) {
    world.warnings.warn(Flag::jumped, fmt::format("{}: {}", name, advice(Flag::jumped)));
  };
  for (const auto& object : world.objects)
    if (jumps(object->motion, world.current.start, world.time)) warn(object->name);
  for (const ColliderRecord& collider : world.colliders)
    if (collider.options.motion.jumps(world.current.start, world.time)) warn(collider.options.name);
}

void raise_flags(WorldState& world) {
  const StepReport& report = world.report;
  flag_jumps(world);
  flag_out_of_range(world);
  flag_not_converged(world);
  if (std::any_of(report.kinds.begin(), report.kinds.end(), [](const KindReport& kind) {
        return kind.kind != NeoHookean::name && kind.largest_strain > large_strain;
      }))
    world.warnings.warn(Flag::large_strain, strain_advice(world));
  if (report.fluid.largest_step > max_fluid_step)
    world.warnings.warn(Flag::coarse_substeps, advice(Flag::coarse_substeps));
  if (!(report.deepest_contact > 0)) return;
  float thickest = 0;
  for (const float radius : world.particles.radius) thickest = std::max(thickest, radius);
  if (report.deepest_contact > 2 * static_cast<double>(thickest))
    world.warnings.warn(Flag::deep_contact, advice(Flag::deep_contact));
}

}  // namespace

std::string_view stage_name(Stage stage) {
  constexpr std::array<std::string_view, stage_count> names{
      "broad_phase", "integrate", "fluids", "contacts", "solve", "finish", "velocity", "foam"};
  const auto index = static_cast<std::size_t>(stage);
  return index < names.size() ? names[index] : "?";
}

std::string_view outcome_name(StepOutcome outcome) {
  constexpr std::array<std::string_view, 4> names{"done", "refused", "diverged", "abandoned"};
  const auto index = static_cast<std::size_t>(outcome);
  return index < names.size() ? names[index] : "?";
}

void restore_last_valid(WorldState& world) {
  Particles& particles = world.particles;
  const std::size_t particle = *world.current.first_non_finite;
  const Object& object = *world.objects[world.object_of[particle]];
  world.report.outcome = StepOutcome::diverged;
  world.report.bad_object = object.name;
  world.report.bad_vertex = object.vertex_of[particle - object.begin];
  particles.position = world.current.last_valid.position;
  particles.offset = world.current.last_valid.offset;
  particles.velocity = world.current.last_valid.velocity;
  particles.spin = world.current.last_valid.spin;
  world.rigid->undo();
  world.constraints.ties->undo();
  update_sleeping_masses(world);
  world.warnings.warn(Flag::non_finite, fmt::format("{}, vertex {}: {}", object.name, world.report.bad_vertex,
                                                    advice(Flag::non_finite)));
}

bool refuse_nested_step(WorldState& world) {
  Calls& calls = *world.calls;
  if (calls.doing == Calls::Doing::nothing && calls.queries == 0) return false;
  calls.nested_step = true;  // perhaps on a thread of the step: its end reports it
  return true;
}

void refuse_step(WorldState& world, const std::string& reason) {
  world.report.outcome = StepOutcome::refused;
  world.warnings.refuse(reason + "; nothing was done");
}

bool begin_report(WorldState& world, double dt) {
  StepReport& report = world.report;
  world.warnings.begin_step();
  std::vector<KindReport> kinds = std::move(report.kinds);
  std::vector<ObjectReport> objects = std::move(report.objects);
  kinds.clear();
  report = {};
  report.kinds = std::move(kinds);
  report.objects = std::move(objects);
  report.step = world.steps;
  report.time = world.time;
  if (!(dt > 0) || !(dt <= range::time) || !(static_cast<float>(dt / world.settings.substeps) > 0)) {
    refuse_step(world,
                fmt::format("step: dt is {} s, expected a positive time of at most {:g} s", dt, range::time));
    return false;
  }
  return true;
}

void count_step(WorldState& world) {
  StepReport& report = world.report;
  world.current.first_non_finite.reset();
  report.step = ++world.steps;
  report.substeps = world.settings.substeps;
  report.iterations = world.settings.iterations;
  for (const auto& object : world.objects) report.particles += object->particle_count();
}

void save_last_valid(WorldState& world) {
  const Particles& particles = world.particles;
  const auto keep = [&world](const std::vector<Vec4f>& array, std::vector<Vec4f>& valid) {
    valid.resize(array.size());
    world.threads->for_each(array.size(), 8192, [&](std::size_t begin, std::size_t end) {
      std::memcpy(&valid[begin], &array[begin], (end - begin) * sizeof(Vec4f));
    });
  };
  keep(particles.position, world.current.last_valid.position);
  keep(particles.offset, world.current.last_valid.offset);
  keep(particles.velocity, world.current.last_valid.velocity);
  keep(particles.spin, world.current.last_valid.spin);
  world.rigid->keep();
  world.constraints.ties->keep();
  world.current.saved = true;
  SOUPLE_ASSERT(world.current.last_valid.offset.size() == particles.size(),
                "arrays of particles have one length");
}

void report_balance(WorldState& world) {
  std::vector<ObjectReport>& reports = world.report.objects;
  reports.resize(world.scratch->balance.object_count());
  for (std::size_t k = 0; k < reports.size(); ++k) {
    const Object& object = *world.objects[world.scratch->balance.object(k)];
    reports[k].name = object.name;
    reports[k].unbalanced = object.imbalance.unbalanced;
    reports[k].stretch = object.imbalance.stretch;
  }
}

void end_report(WorldState& world, bool valid) {
  world.report.time = world.time;
  if (world.calls->nested_step.exchange(false))
    world.warnings.warn(Flag::callback_failed,
                        "step: a function that the world was calling called step; that call did nothing");
  world.warnings.report_log_failure();
  report_fluids(world);
  report_custom_errors(world);
  report_joints(world);
  report_ties(world);
  measure(world);
  if (valid) raise_flags(world);
}

void run_callbacks(World& self, WorldState& world,
                   const CallbackList<std::function<void(World&)>>& callbacks) {
  callbacks.for_each([&](const std::function<void(World&)>& callback) {
    world.warnings.guarded("a stage's callback", [&] {
      const CallScope call(*world.calls, Calls::Doing::callback);  // over when the log hears of an exception
      callback(self);
    });
  });
}

}  // namespace souple
