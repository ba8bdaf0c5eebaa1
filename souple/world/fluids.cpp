#include "souple/world/fluids.h"

#include "souple/contacts/particle_position.h"
#include "souple/objects/collider_record.h"
#include "souple/world/contact_state.h"
#include "souple/world/state.h"

#include <algorithm>
#include <cmath>

namespace souple {

namespace {

constexpr std::size_t grain = 512;  // minimum number of particles per thread
// In spacings; the density solver keeps particles at half a spacing.
constexpr float min_wall_distance = 0.25f;

/// Interface of the density solver to walls and bodies.
struct Boundary {
  LocalBoundary& local_boundary;
  FluidBodies& bodies;
  const SubResolutionBodies& sub_resolution_bodies;
  const Smoothing& smoothing;

  template <class Function>
  void for_near(std::size_t count, Threads& threads, const Function& f) const {
    if (!sub_resolution_bodies.none()) return for_each_index(count, threads, f);
    const std::span<const std::uint32_t> near = local_boundary.near();
    for_each_index(near.size(), threads, [&](std::size_t k) { f(near[k]); });
  }
  BoundarySums sample(std::size_t index, const Vec3f& x) const {
    const std::span<BoundaryPlane> planes = local_boundary.of(index);
    for (BoundaryPlane& plane : planes) bodies.follow(plane);
    BoundarySums sums = sample_planes(planes, x, smoothing);
    if (!sub_resolution_bodies.none()) sums.value += sub_resolution_bodies.displaced_fraction(index);
    return sums;
  }
  void after_sampling(std::span<const Vec4f> x, CoarsePressure& coarse) const {
    if (bodies.mesh_count() > 0) bodies.find_response(local_boundary, x, coarse);
  }
  void add_response(std::size_t index, BoundarySums& sums) const {
    if (bodies.mesh_count() > 0) bodies.add_response(local_boundary.of(index), sums);
  }
  void add_push(std::size_t index, float change) const {
    for (BoundaryPlane& plane : local_boundary.of(index)) plane.push_sum += plane.slope * change;
  }
  void after_pushes(std::span<const float> change) const {
    if (bodies.mesh_count() > 0) bodies.displace(local_boundary, change);
  }
};

/// Origin of a fluid's coordinates: floats far from it are coarse. It is a multiple of one meter or, for
/// spacings below 2 mm, of a power of two of at least 256 spacings.
Vec3d origin_near(const Vec3d& x, float spacing) {
  const double cell = min(1.0, std::ldexp(1.0, std::ilogb(256 * double{spacing}) + 1));
  return {std::floor(x.x / cell) * cell, std::floor(x.y / cell) * cell, std::floor(x.z / cell) * cell};
}

/// The displacement that restores the distance `radius` between x and the walls [m].
Vec3f wall_correction(const Vec3f& x, std::span<const BoundaryPlane> planes, float radius) {
  Vec3f correction{};
  for (const BoundaryPlane& plane : planes) {
    const float distance = dot(plane.normal, x + correction) - plane.offset;
    if (plane.mesh == BoundaryPlane::none && distance < radius)
      correction += plane.normal * (radius - distance);
  }
  return correction;
}

}  // namespace

void Fluids::begin_step(WorldState& world, double dt) {
  registry_.find_particles(world);
  statistics_.begin_step(registry_.particle.size());
  if (none()) return;
  inflow_.begin_step(world, dt, registry_.particle);
  choose_solver(world);
  solver_->begin_step();
  origin_ = origin_near(world.exact_position(registry_.particle[0]), registry_.materials[0].spacing);
  bodies_.begin_step(registry_.collides_with_body, origin_);
  sub_resolution_bodies_.begin_step(registry_.collides_with_sub_resolution, registry_.sub_resolution.size(),
                                    registry_.fluid, origin_);
  world.warnings.guarded("a collider's motion", [&] {
    walls_.begin_step(world.contact->tables.colliders, registry_.collides_with_collider, origin_,
                      registry_.particle.size(), world.time);
  });
}

void Fluids::choose_solver(const WorldState& world) {
  const float spacing = registry_.materials[0].spacing;
  const DensitySolver::Options wanted{.shape = world.settings.fluid.kernel,
                                      .passes = world.settings.fluid.iterations,
                                      .tolerance = world.settings.fluid.tolerance,
                                      .compressibility = world.settings.fluid.compressibility,
                                      .artificial_pressure = world.settings.fluid.artificial_pressure};
  if (solver_ && spacing_ == spacing && options_ == wanted) return;
  solver_ = std::make_unique<DensitySolver>(spacing, wanted);
  viscosity_ = Viscosity(wanted.shape);
  surface_tension_ = SurfaceTension(wanted.shape);
  vorticity_ = VorticityConfinement(wanted.shape);
  spacing_ = spacing;
  options_ = wanted;
}

void Fluids::set_positions(WorldState& world, float h, Threads& threads) {
  inflow_.begin_substep(world);
  const std::vector<std::uint32_t>& particle = registry_.particle;
  positions_.resize(particle.size());
  start_.resize(particle.size());
  const Particles& particles = world.particles;
  const ParticleView view = world.view();
  const float radius = min_wall_distance * spacing_;
  const bool displaced = world.settings.form == Form::displacement;
  threads.for_each(particle.size(), grain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) {
      const Vec4f& x = particles.position[particle[k]];
      Vec3f at(Vec3d(x.xyz()) - origin_);
      if (displaced) at += particles.offset[particle[k]].xyz();
      start_[k] = Vec3f(particle_start_position(view, particle[k]) - origin_);
      const Vec3d velocity(particles.velocity[particle[k]].xyz());
      const bool is_inflow = inflow_.update(k, Vec3d(start_[k]) + origin_, velocity);
      const Vec3f aim = is_inflow ? start_[k] + inflow_.velocity(k) * h : at;
      const Vec3f kept = walls_.keep_out(k, registry_.fluid[k], start_[k], aim, radius);
      view.correct(particle[k], kept - at);
      positions_[k] = {kept.x, kept.y, kept.z, x.w};
    }
  });
  solver_->set_positions(positions_, threads);
}

void Fluids::sample_boundary(Threads& threads) {
  const float search_radius = LocalBoundary::search_radius(solver_->smoothing());
  const auto order = solver_->order();
  const auto x = solver_->positions();
  local_boundary_.gather(
      x.size(),
      [&](std::size_t k, std::vector<BoundaryPlane>& planes) {
        const std::uint32_t i = order[k];
        walls_.find(i, registry_.fluid[i], x[k].xyz(), search_radius, planes);
        if (bodies_.mesh_count() > 0)
          bodies_.find(i, registry_.fluid[i], x[k].xyz(), start_[i], search_radius, planes);
      },
      threads);
}

void Fluids::solve_incompressibility(WorldState& world, const Substep& substep) {
  Threads& threads = *world.threads;
  world.warnings.guarded("a collider's motion",
                         [&] { walls_.begin_substep(world.time, static_cast<double>(substep.h)); });
  set_positions(world, substep.h, threads);
  const Smoothing& smoothing = solver_->smoothing();
  const ParticleView particles = world.view();
  if (bodies_.mesh_count() > 0)
    bodies_.begin_substep(particles, world.particles.mass, positions_,
                          LocalBoundary::search_radius(smoothing), threads);
  sample_boundary(threads);
  if (!sub_resolution_bodies_.none())
    sub_resolution_bodies_.find(solver_->positions(), solver_->order(), local_boundary_, smoothing, particles,
                                threads);
  Boundary boundary{local_boundary_, bodies_, sub_resolution_bodies_, smoothing};
  solver_->solve(boundary, threads, substep.h);
  apply_corrections(particles, threads);
  statistics_.add_pressures(*solver_, local_boundary_, world.contact->tables.colliders.size(), substep.h,
                            substep.count, threads);
}

// Applies the solver's result to the world's particles and the bodies.
void Fluids::apply_corrections(const ParticleView& particles, Threads& threads) {
  const auto order = solver_->order();
  const auto moved = solver_->moved();
  const auto body_pushes = sub_resolution_bodies_.none() ? std::span<const Vec3f>{}
                                                         : sub_resolution_bodies_.apply_pressure(
                                                               solver_->positions(), moved, particles);
  threads.for_each(order.size(), grain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) {
      if (inflow_.is_inflow(order[k])) continue;
      const std::uint32_t i = registry_.particle[order[k]];
      const Vec3f at = solver_->positions()[k].xyz();
      particles.correct(i,
                        moved[k] + wall_correction(at, local_boundary_.of(k), min_wall_distance * spacing_));
      if (!body_pushes.empty()) particles.correct(i, body_pushes[k] * -solver_->positions()[k].w);
    }
  });
  if (bodies_.mesh_count() == 0) return;
  bodies_.apply(local_boundary_, particles);
  keep_out_of_bodies(particles);
}

void Fluids::keep_out_of_bodies(const ParticleView& particles) const {
  const auto order = solver_->order();
  for (const std::uint32_t k : local_boundary_.near()) {
    if (inflow_.is_inflow(order[k])) continue;
    const Vec3f x = solver_->positions()[k].xyz();
    for (const BoundaryPlane& plane : local_boundary_.of(k))
      if (plane.mesh != BoundaryPlane::none)
        bodies_.keep_apart(plane, registry_.particle[order[k]], x, min_wall_distance * spacing_, particles);
  }
}

FluidView Fluids::view() {
  return {solver_->padded_positions(), velocity_, solver_->neighbors(), solver_->smoothing()};
}

FluidReport Fluids::report() const {
  FluidReport report = statistics_.report();
  foam_.report(report);
  return report;
}

float Fluids::pressure(std::uint32_t particle) const {
  const auto at = std::lower_bound(registry_.particle.begin(), registry_.particle.end(), particle);
  if (at == registry_.particle.end() || *at != particle) return 0;
  return statistics_.pressure(static_cast<std::size_t>(at - registry_.particle.begin()));
}

}  // namespace souple
