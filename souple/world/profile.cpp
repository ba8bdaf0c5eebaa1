#include "souple/world/profile.h"

#include "souple/constraints/distance.h"
#include "souple/solver/solver.h"
#include "souple/world/call_scope.h"
#include "souple/world/impl.h"
#include "souple/world/prepare.h"
#include "souple/world/world.h"

#include <algorithm>
#include <chrono>
#include <cmath>

namespace souple {
namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

/// Prepares the world for a solve and restores all particles at its end. Other state that a substep writes
/// (multipliers, contacts) is initialized again by the next.
class MeasurementScope {
 public:
  MeasurementScope(WorldState& world, const char* what) : world_(world), step_(callable(world, what)) {
    bring_up_to_date(world);
    position_ = world.particles.position;
    offset_ = world.particles.offset;
    world.particles.start = offset_;
    world.threads->wake();
  }
  MeasurementScope(const MeasurementScope&) = delete;
  MeasurementScope& operator=(const MeasurementScope&) = delete;
  ~MeasurementScope() {
    world_.threads->rest();
    world_.particles.position.swap(position_);
    world_.particles.offset.swap(offset_);
  }

 private:
  static Calls& callable(WorldState& world, const char* what) {
    require_callable(*world.calls, what, From::nowhere);
    return *world.calls;
  }

  WorldState& world_;
  StepScope step_;
  std::vector<Vec4f> position_, offset_;
};

double median(std::vector<double>& values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

void add_strains(const Projector& projector, const ParticleView& view, SolveTime& result) {
  if (projector.kind() != Distance::name) return;
  result.count += projector.size();
  projector.visit(view, [&](const ConstraintState& constraint) {
    const auto strain = static_cast<double>(constraint.strain);
    result.mean_strain += std::fabs(strain);
    result.rms_strain += strain * strain;
    result.largest_strain = std::max(result.largest_strain, strain);
    const auto C = static_cast<double>(constraint.residual);
    result.energy += 0.5 * C * C;
  });
}

}  // namespace

std::vector<KindTime> World::time_projections(double dt, int sweeps) {
  WorldState& world = state();
  const MeasurementScope scope(world, "time_projections");
  const Substep substep = substep_of(world.settings, dt);
  const ParticleView view = world.view();
  std::vector<KindTime> result;
  for (Projector* const projector : world.constraints.lasting()) {
    std::vector<double> seconds;
    projector->begin_substep(view, substep);
    for (int i = 0; i < std::max(sweeps, 1); ++i) {
      const auto start = Clock::now();
      sweep(*projector, view, substep, *world.threads);
      seconds.push_back(seconds_since(start));
    }
    result.push_back({projector->kind(), projector->size(), median(seconds)});
  }
  return result;
}

SolveTime World::time_solve(double dt, int iterations) {
  WorldState& world = state();
  const MeasurementScope scope(world, "time_solve");
  Substep substep = substep_of(world.settings, dt);
  substep.iterations = iterations;
  const ParticleView view = world.view();
  SolveTime result;
  const auto start = Clock::now();
  for (Projector* const projector : world.constraints.order) projector->begin_substep(view, substep);
  if (iterations > 0) world.solving.solver->solve(world.constraints.order, view, substep, *world.threads);
  result.seconds = seconds_since(start);
  result.diagnostic = world.solving.solver->diagnostic();
  for (const Projector* projector : world.constraints.lasting()) add_strains(*projector, view, result);
  if (result.count > 0) {
    result.mean_strain /= static_cast<double>(result.count);
    result.rms_strain = std::sqrt(result.rms_strain / static_cast<double>(result.count));
  }
  return result;
}

}  // namespace souple
