#include "souple/world/fluid_foam.h"

#include "souple/objects/collider_record.h"
#include "souple/state/bytes.h"
#include "souple/world/contact_state.h"
#include "souple/world/fluids.h"
#include "souple/world/stages.h"
#include "souple/world/state.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace souple {

namespace {

constexpr float min_wall_distance = 0.1f;                   // distance from walls and bodies, in spacings
constexpr std::size_t max_reserved = std::size_t{1} << 18;  // particles; more memory is allocated on demand

}  // namespace

void FluidFoam::choose_shape(SmoothingShape shape, std::size_t max_particles) {
  if (shape != shape_) {
    FoamState state = foam_->state();
    *foam_ = Foam(shape);
    foam_->set_state(std::move(state));
    shape_ = shape;
  }
  const std::size_t capacity = std::min(max_particles, max_reserved);
  foam_->reserve(capacity);
  unconstrained_.reserve(capacity);
  positions_.reserve(capacity);
}

void FluidFoam::step(WorldState& world, const FluidView& fluid, const Source& source, double time,
                     double dt) {
  Threads& threads = *world.threads;
  const FoamParameters& parameters = world.settings.fluid.foam;
  choose_shape(world.settings.fluid.kernel, parameters.max_particles);
  if (!(origin_ == source.origin)) foam_->shift(Vec3f(origin_ - source.origin));
  origin_ = source.origin;
  world.warnings.guarded("a collider's motion", [&] {
    walls_.begin_step(world.contact->tables.colliders, source.collides_with_collider, origin_, 0, time);
    walls_.begin_substep(time, dt);
  });
  const float gap = min_wall_distance * fluid.smoothing.spacing();
  find_bodies(world, source, gap, threads);
  const FoamStep step{.fluid = fluid,
                      .particle = source.particle,
                      .wall_slopes = source.wall_slopes,
                      .share = source.share,
                      .gravity = world.settings.gravity,
                      .dt = static_cast<float>(dt),
                      .seed = world.settings.seed * 0x9e3779b97f4a7c15u + world.steps};
  report_ = foam_->step(
      step, parameters,
      [&](std::span<const Vec3f> start, std::span<Vec3f> x, std::span<Vec3f> v) {
        keep_out(start, x, v, gap, step.dt, threads);
      },
      threads);
  update_positions();
}

// Bodies move straight from their positions at the start of the step to those at its end.
void FluidFoam::find_bodies(const WorldState& world, const Source& source, float gap, Threads& threads) {
  bodies_.clear();
  const Particles& particles = world.particles;
  for (std::size_t s = 0; s < source.meshes.size(); ++s) {
    if (source.collides_with_body[s] == 0) continue;
    const BoundaryMesh& mesh = source.meshes[s];
    start_.resize(mesh.particles.size());
    end_.resize(mesh.particles.size());
    for_each_index(mesh.particles.size(), threads, [&](std::size_t v) {
      Vec3d before{}, after{};
      for (std::size_t k = 0; k < 4; ++k) {
        const std::uint32_t i = mesh.particles[v][k];
        const auto weight = static_cast<double>(mesh.weights[v][k]);
        if (weight == 0) continue;
        before +=
            (Vec3d(world.last_valid.position[i].xyz()) + Vec3d(world.last_valid.offset[i].xyz()) - origin_) *
            weight;
        after += (Vec3d(particles.position[i].xyz()) + Vec3d(particles.offset[i].xyz()) - origin_) * weight;
      }
      start_[v] = Vec3f(before);
      end_[v] = Vec3f(after);
    });
    for (const auto& [a, b, c] : mesh.triangles)
      bodies_.add({start_[a], start_[b], start_[c]}, {end_[a], end_[b], end_[c]}, mesh.half_thickness + gap);
  }
  if (!bodies_.none()) bodies_.build(threads);
}

// A particle that a wall pushes gets at least the velocity away from the wall that it had on average in this
// step.
void FluidFoam::keep_out(std::span<const Vec3f> start, std::span<Vec3f> x, std::span<Vec3f> v, float gap,
                         float dt, Threads& threads) {
  unconstrained_.assign(x.begin(), x.end());
  const auto out_of_walls = [&] {
    for_each_index(x.size(), threads, [&](std::size_t k) {
      if (is_finite(x[k])) x[k] = walls_.keep_out(0, start[k], x[k], gap);
    });
  };
  out_of_walls();
  if (!bodies_.none()) {
    bodies_.keep_out(start, x, threads);
    out_of_walls();
  }
  for_each_index(x.size(), threads, [&](std::size_t k) {
    const Vec3f push = x[k] - unconstrained_[k];
    const float size = length(push);
    if (!(size > 0)) return;
    const Vec3f normal = push * (1 / size);
    const float least = dot(normal, x[k] - start[k]) / dt;
    v[k] += normal * std::max(0.0f, least - dot(normal, v[k]));
  });
}

void FluidFoam::update_positions() {
  positions_.resize(foam_->size());
  for (std::size_t k = 0; k < positions_.size(); ++k)
    positions_[k] = Vec3f(origin_ + Vec3d(foam_->positions()[k]));
}

void FluidFoam::clear() {
  foam_->clear();
  positions_.clear();
  report_ = {};
}

void FluidFoam::set_state(FoamState state, const Vec3d& origin) {
  foam_->set_state(std::move(state));
  origin_ = origin;
  update_positions();
}

std::span<const Vec3f> FluidFoam::velocities() const {
  return foam_->velocities();
}

std::span<const FoamKind> FluidFoam::kinds() const {
  return foam_->kinds();
}

void FluidFoam::report(FluidReport& report) const {
  report.spray = report_.spray;
  report.foam = report_.foam;
  report.bubbles = report_.bubbles;
}

std::size_t FluidFoam::bytes() const {
  return foam_->bytes() + bodies_.bytes() + bytes_of(start_, end_, unconstrained_, positions_);
}

// --- data from the fluids -------------------------------------------------------------------------

void Fluids::step_foam(WorldState& world, double time, double dt) {
  const bool foams = std::any_of(registry_.materials.begin(), registry_.materials.end(),
                                 [](const FluidMaterial& material) { return material.foam > 0; });
  if (none() || (!foams && foam_.size() == 0)) return foam_.clear();
  const auto order = solver_->order();
  const auto x = solver_->positions();
  FluidFoam::Source& source = foam_source_;
  source.particle.resize(order.size());
  source.share.resize(order.size());
  source.wall_slopes.resize(order.size());
  for_each_index(order.size(), *world.threads, [&](std::size_t k) {
    source.particle[k] = registry_.particle[order[k]];
    source.share[k] = registry_.materials[registry_.fluid[order[k]]].foam;
    source.wall_slopes[k] = sample_planes(local_boundary_.of(k), x[k].xyz(), solver_->smoothing()).slope;
  });
  const auto some = [](const std::vector<std::uint8_t>& of_each, std::size_t count,
                       std::vector<std::uint8_t>& result) {
    result.assign(count, 0);
    for (std::size_t n = 0; n < of_each.size(); ++n) result[n % count] |= of_each[n];
  };
  some(registry_.collides_with_collider, world.contact->tables.colliders.size(),
       source.collides_with_collider);
  some(registry_.collides_with_body, registry_.with_boundary.size(), source.collides_with_body);
  source.meshes = bodies_.meshes();
  source.origin = origin_;
  foam_.step(world, view(), source, time, dt);
}

void step_foam(WorldState& world, double time, double dt) {
  world.fluids->step_foam(world, time, dt);
}

}  // namespace souple
