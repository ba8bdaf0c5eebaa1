#include "souple/world/stages.h"

#include "souple/assert.h"
#include "souple/objects/object.h"
#include "souple/simd/instruction_set.h"
#include "souple/solver/kernels/find_kernels.h"
#include "souple/solver/kernels/motion.h"
#include "souple/solver/solver.h"
#include "souple/world/balance.h"
#include "souple/world/contact_state.h"
#include "souple/world/contacts.h"
#include "souple/world/damping.h"
#include "souple/world/fluids.h"
#include "souple/world/forces.h"
#include "souple/world/obstacles.h"
#include "souple/world/projectors.h"
#include "souple/world/sleeping.h"
#include "souple/world/spin.h"
#include "souple/world/step_scratch.h"
#include "souple/world/user_constraint.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>

namespace souple {
namespace {

std::vector<Vec4f>& moving(WorldState& world) {
  return world.objects_view().moving();
}

// Minimum number of particles per thread.
constexpr std::size_t grain = 2048;

bool is_non_finite(const Vec3f& v) {
  return !std::isfinite(v.x + v.y + v.z);
}

/// The lowest particle that any thread found non-finite. It identifies the origin, because the solver would
/// spread the value within the substep.
class FirstNonFinite {
 public:
  void note(std::size_t i) {
    std::size_t current = lowest_;
    while (i < current && !lowest_.compare_exchange_weak(current, i)) {
    }
  }
  void report_to(WorldState& world) const {
    if (lowest_ != none && !world.current.first_non_finite) world.current.first_non_finite = lowest_;
  }

 private:
  static constexpr std::size_t none = std::numeric_limits<std::size_t>::max();
  std::atomic<std::size_t> lowest_{none};
};

/// Wind of a substep.
struct Air {
  bool windy;
  Vec3f wind;
};

void predict_one(WorldState& world, std::size_t i, const Substep& substep, const Air& air,
                 std::vector<Vec4f>& p, FirstNonFinite& first_non_finite) {
  Particles& particles = world.particles;
  particles.start[i] = p[i];
  if (particles.position[i].w == 0) return;
  const float h = substep.h;
  const Vec3f v = particles.velocity[i].xyz();
  const Vec3f x = particles.position[i].xyz();
  Vec3f v_star, move;
  switch (world.settings.integrator) {
    case Integrator::semi_implicit:
      v_star = v + acceleration(world, i, x, v, air.windy, air.wind, world.time) * h;
      move = v_star * h;
      break;
    case Integrator::explicit_euler:
      v_star = v + acceleration(world, i, x, v, air.windy, air.wind, world.time) * h;
      move = v * h;
      break;
    case Integrator::implicit_euler:
      v_star = implicit_velocity(world, i, x, v, h, air.windy, air.wind, world.time + static_cast<double>(h));
      move = v_star * h;
      break;
  }
  if (is_non_finite(v_star)) first_non_finite.note(i);
  particles.velocity[i].set_xyz(v_star);
  p[i].set_xyz(p[i].xyz() + move);
}

void finish_one(WorldState& world, std::size_t i, const Substep& substep, const std::vector<Vec4f>& p,
                FirstNonFinite& first_non_finite) {
  Particles& particles = world.particles;
  // v = v* + (p - p*) / h: a particle without corrections keeps its velocity bitwise. The semi-implicit p* is
  // recomputed from v* with the rounding of the prediction. A pinned particle has no v*: v = (p - x) / h.
  const bool semi_implicit = world.settings.integrator == Integrator::semi_implicit;
  const Vec3f start = particles.start[i].xyz();
  const Vec3f v_star = particles.velocity[i].xyz();
  const bool pinned = particles.position[i].w == 0;
  const Vec3f base = pinned ? Vec3f{} : v_star;
  const Vec3f since = pinned          ? start
                      : semi_implicit ? start + v_star * substep.h
                                      : world.scratch->predicted[i].xyz();
  const Vec3f v = base + (p[i].xyz() - since) / substep.h;
  particles.velocity[i].set_xyz(v);
  if (is_non_finite(v)) first_non_finite.note(i);
  if (world.settings.form == Form::plain) return;
  // x += q; the part beyond the precision of x stays in the offset.
  const Vec3f q = particles.offset[i].xyz();
  const Vec3f x = particles.position[i].xyz();
  const Vec3f moved = x + q;
  particles.position[i].set_xyz(moved);
  particles.offset[i].set_xyz(q - (moved - x));
  if (is_non_finite(moved)) first_non_finite.note(i);
}

// SIMD kernels of predict_one and finish_one, or null if none applies.
const kernels::MotionKernels* packed(const Settings& settings) {
  return settings.integrator == Integrator::semi_implicit ? find_motion_kernels(instruction_set()) : nullptr;
}

kernels::MotionArrays arrays_of(WorldState& world, bool windy) {
  Particles& particles = world.particles;
  if (particles.size() == 0) return {};
  return {&particles.position.data()->x, &moving(world).data()->x, &particles.start.data()->x,
          &particles.velocity.data()->x, windy ? &world.scratch->force.data()->x : nullptr};
}

// The SIMD kernels report only that a value may be non-finite.
void find_non_finite(const WorldState& world, std::size_t begin, std::size_t end,
                     FirstNonFinite& first_non_finite) {
  const Particles& particles = world.particles;
  for (std::size_t i = begin; i < end; ++i)
    if (is_non_finite(particles.velocity[i].xyz()) || is_non_finite(particles.position[i].xyz()))
      return first_non_finite.note(i);
}

bool has_no_mass(std::span<const Vec4f> displacements) {
  return std::all_of(displacements.begin(), displacements.end(), [](const Vec4f& d) { return d.w == 0; });
}

void predict(WorldState& world, const Substep& substep) {
  const Settings& settings = world.settings;
  const Air air{accumulate_wind(world, substep.h), wind_at(settings, world.time)};
  const std::size_t count = world.particles.size();
  std::vector<Vec4f>& p = moving(world);
  FirstNonFinite first_non_finite;
  const auto one_by_one = [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) predict_one(world, i, substep, air, p, first_non_finite);
  };
  const kernels::MotionKernels* kernels = packed(settings);
  if (!world.callbacks.force_fields.empty()) {
    one_by_one(0, count);  // users' functions run on the user's thread
  } else if (!kernels || settings.drag > 0) {
    world.threads->for_each(count, grain, one_by_one);
  } else {
    const Vec3f& g = settings.gravity;
    const float gravity[3] = {g.x, g.y, g.z};
    const kernels::MotionArrays arrays = arrays_of(world, air.windy);
    world.threads->for_each(count, grain, [&](std::size_t begin, std::size_t end) {
      if (!kernels->predict(arrays, begin, end, gravity, substep.h))
        find_non_finite(world, begin, end, first_non_finite);
    });
  }
  first_non_finite.report_to(world);
}

// Moves pinned particles to target(vertex, t + h) + offset, or on their way to where they arrive at the end of
// the step; others stay.
void drive_pins(WorldState& world, const Substep& substep) {
  const double t = world.time + static_cast<double>(substep.h);
  const double s = (t - world.current.start) / world.current.length;
  std::vector<Vec4f>& p = moving(world);
  for (const auto& object : world.objects) {
    for (const PinnedParticle& pin : object->pins) {
      if (!pin.target && !pin.arrival) continue;
      const std::uint32_t i = object->begin + pin.particle;
      Vec3d goal = world.exact_position(i);
      if (pin.arrival)
        goal = world.current.last_substep ? *pin.arrival : pin.from + (*pin.arrival - pin.from) * s;
      else
        world.warnings.guarded("a pin's target", [&] { goal = (*pin.target)(pin.vertex, t) + pin.offset; });
      if (world.settings.form == Form::plain) {
        p[i].set_xyz(Vec3f(goal));
      } else {
        p[i].set_xyz(Vec3f(goal - Vec3d(world.particles.position[i].xyz())));
      }
    }
  }
}

void drive_attachments(WorldState& world, const Substep& substep) {
  const double t = world.time + static_cast<double>(substep.h);
  for (UserConstraint& user_constraint : world.constraints.users)
    world.warnings.guarded("an attachment's target", [&] { user_constraint.update_targets(t); });
}

// Kelvin-Voigt damping of the constraints, on the velocities of the substep. PBD mode has none.
void damp_constraints(WorldState& world, const Substep& substep) {
  if (world.sleep->all || substep.mode == Mode::pbd) return;
  const ParticleView view = world.view();
  const std::span<Vec4f> velocity = world.particles.velocity;
  for_each_projector(world,
                     [&](Projector& projector) { projector.damp(view, velocity, substep, *world.threads); });
}

// Stiffnesses of PBD are no forces, and phantoms no particles.
bool measures_balance(const WorldState& world) {
  const Settings& settings = world.settings;
  return world.current.last_substep && settings.measure_residuals && settings.mode != Mode::pbd &&
         settings.solver.colors == 0;
}

}  // namespace

void integrate(WorldState& world, const Substep& substep) {
  if (world.sleep->woken) find_candidates(world, static_cast<double>(substep.h) * substep.count);
  predict(world, substep);
  predict_spin(world, substep);
  drive_pins(world, substep);
  drive_obstacles(world, substep);
  drive_attachments(world, substep);
  if (world.settings.integrator != Integrator::semi_implicit) world.scratch->predicted = moving(world);
}

void solve_incompressibility(WorldState& world, const Substep& substep) {
  if (!world.fluids->none() && !world.current.first_non_finite)
    world.fluids->solve_incompressibility(world, substep);
}

void solve(WorldState& world, const Substep& substep) {
  if (world.sleep->all) return;
  SOUPLE_ASSERT(!world.dirty.solver && !world.dirty.constraints, "a step prepares its solver");
  const ParticleView view = world.view();
  for_each_projector(world, [&](Projector& projector) { projector.begin_substep(view, substep); });
  Substep solved = substep;
  solved.levels = !world.contact->contacts.separates();
  if (measures_balance(world)) {
    solved.external = &world.balance->external();
    world.balance->begin(world.steps, view);
    world.solving.solver->solve(world.constraints.order, view, solved, *world.threads);
    world.balance->measure(world, view, substep);
  } else {
    world.solving.solver->solve(world.constraints.order, view, solved, *world.threads);
    if (world.current.last_substep) world.report.objects.clear();
  }
  keep_apart(world, substep);
}

bool finish(WorldState& world, const Substep& substep) {
  const std::size_t count = world.particles.size();
  SOUPLE_ASSERT(world.settings.form == Form::plain || has_no_mass(world.particles.offset),
                "displacements have no mass in their last lane");
  const std::vector<Vec4f>& p = moving(world);
  FirstNonFinite first_non_finite;
  if (const kernels::MotionKernels* kernels = packed(world.settings)) {
    const kernels::MotionArrays arrays = arrays_of(world, false);
    const kernels::Finish finish_packed = kernels->finish[world.settings.form == Form::plain ? 0 : 1];
    world.threads->for_each(count, grain, [&](std::size_t begin, std::size_t end) {
      if (!finish_packed(arrays, begin, end, substep.h)) find_non_finite(world, begin, end, first_non_finite);
    });
  } else {
    world.threads->for_each(count, grain, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) finish_one(world, i, substep, p, first_non_finite);
    });
  }
  first_non_finite.report_to(world);
  ++world.version;
  return !world.current.first_non_finite;
}

void update_velocities(WorldState& world, const Substep& substep) {
  apply_restitution(world, substep);
  finish_spin(world, substep);
  damp_constraints(world, substep);
  if (!world.fluids->none() && !world.current.first_non_finite)
    world.fluids->update_velocities(world, substep);
  for (const auto& object : world.objects)
    if (object->island == 0) damp(world, *object, substep.h);
}

}  // namespace souple
