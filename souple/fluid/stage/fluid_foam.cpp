#include "souple/fluid/stage/fluid_foam.h"

#include "souple/fluid/fluid_report.h"
#include "souple/fluid/fluid_settings.h"
#include "souple/fluid/stage/fluid_input.h"
#include "souple/fluid/stage/fluid_state.h"
#include "souple/state/bytes.h"

#include <algorithm>
#include <utility>

namespace souple {

namespace {

constexpr float min_foam_distance = 0.1f;                   // distance from walls and bodies, in spacings
constexpr std::size_t max_reserved = std::size_t{1} << 18;  // particles; more memory is allocated on demand

}  // namespace

void FluidFoam::choose_shape(SmoothingShape shape, std::size_t max_particles) {
  if (shape != shape_) {
    FoamState state = foam_.state();
    foam_ = Foam(shape);
    foam_.set_state(std::move(state));
    shape_ = shape;
  }
  const std::size_t capacity = std::min(max_particles, max_reserved);
  foam_.reserve(capacity);
  collisions_.reserve(capacity);
  positions_.reserve(capacity);
}

void FluidFoam::set_origin(const Vec3d& origin) {
  if (!(origin_ == origin)) foam_.shift(Vec3f(origin_ - origin));
  origin_ = origin;
}

void FluidFoam::read_fluids(FluidState& fluids, Threads& threads) {
  const DensitySolver& solver = *fluids.solver;
  const FluidRegistry& registry = fluids.registry;
  const auto order = solver.order();
  const auto x = solver.positions();
  particle_.resize(order.size());
  share_.resize(order.size());
  wall_slopes_.resize(order.size());
  for_each_index(order.size(), threads, [&](std::size_t k) {
    particle_[k] = registry.particle[order[k]];
    share_[k] = registry.materials[registry.fluid[order[k]]].foam;
    wall_slopes_[k] = sample_planes(fluids.boundary.local.of(k), x[k].xyz(), solver.smoothing()).slope;
  });
}

void FluidFoam::step(const FluidInput& input, const FoamInput& foam, FluidState& fluids,
                     const FluidView& view) {
  const FoamParameters& parameters = input.settings.foam;
  choose_shape(input.settings.kernel, parameters.max_particles);
  read_fluids(fluids, input.threads);
  set_origin(fluids.origin);
  collisions_.begin_step(input, foam, fluids, min_foam_distance * view.smoothing.spacing());
  const FoamStep step{.fluid = view,
                      .particle = particle_,
                      .wall_slopes = wall_slopes_,
                      .share = share_,
                      .gravity = foam.gravity,
                      .dt = static_cast<float>(foam.dt),
                      .seed = foam.seed};
  report_ = foam_.step(
      step, parameters,
      [&](std::span<const Vec3f> start, std::span<Vec3f> x, std::span<Vec3f> v) {
        collisions_.keep_out(start, x, v, step.dt, input.threads);
      },
      input.threads);
  update_positions();
}

void FluidFoam::update_positions() {
  positions_.resize(foam_.size());
  for (std::size_t k = 0; k < positions_.size(); ++k)
    positions_[k] = Vec3f(origin_ + Vec3d(foam_.positions()[k]));
}

void FluidFoam::clear() {
  foam_.clear();
  positions_.clear();
  report_ = {};
}

void FluidFoam::set_state(FoamState state, const Vec3d& origin) {
  foam_.set_state(std::move(state));
  origin_ = origin;
  update_positions();
}

void FluidFoam::report(FluidReport& report) const {
  report.spray = report_.spray;
  report.foam = report_.foam;
  report.bubbles = report_.bubbles;
}

std::size_t FluidFoam::bytes() const {
  return foam_.bytes() + collisions_.bytes() + bytes_of(positions_);
}

}  // namespace souple
