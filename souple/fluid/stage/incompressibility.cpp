#include "souple/fluid/stage/incompressibility.h"

#include "souple/fluid/stage/fluid_input.h"
#include "souple/fluid/stage/fluid_state.h"
#include "souple/state/warnings.h"

namespace souple {

namespace {

constexpr std::size_t density_grain = 512;  // minimum number of particles per thread
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
    if (!sub_resolution_bodies.none()) sums.value += sub_resolution_bodies.displaced_density(index);
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

void keep_out_of_bodies(const FluidState& fluids, const ParticleView& particles) {
  const DensitySolver& solver = *fluids.solver;
  const LocalBoundary& local_boundary = fluids.boundary.local;
  const auto order = solver.order();
  for (const std::uint32_t k : local_boundary.near()) {
    if (fluids.inflow.is_inflow(order[k])) continue;
    const Vec3f x = solver.positions()[k].xyz();
    for (const BoundaryPlane& plane : local_boundary.of(k))
      if (plane.mesh != BoundaryPlane::none)
        fluids.boundary.bodies.keep_apart(plane, fluids.registry.particle[order[k]], x,
                                          min_wall_distance * fluids.spacing, particles);
  }
}

// Applies the solver's result to the world's particles and the bodies.
void apply_corrections(FluidState& fluids, const ParticleView& particles, Threads& threads) {
  const DensitySolver& solver = *fluids.solver;
  const LocalBoundary& local_boundary = fluids.boundary.local;
  SubResolutionBodies& small = fluids.boundary.sub_resolution;
  const auto order = solver.order();
  const auto moved = solver.moved();
  const auto body_pushes =
      small.none() ? std::span<const Vec3f>{} : small.apply_pressure(solver.positions(), moved, particles);
  threads.each(order.size(), density_grain, [&](std::size_t k) {
    if (fluids.inflow.is_inflow(order[k])) return;
    const std::uint32_t i = fluids.registry.particle[order[k]];
    const Vec3f at = solver.positions()[k].xyz();
    particles.correct(
        i, moved[k] + wall_correction(at, local_boundary.of(k), min_wall_distance * fluids.spacing));
    if (!body_pushes.empty()) particles.correct(i, body_pushes[k] * -solver.positions()[k].w);
  });
  if (fluids.boundary.bodies.mesh_count() == 0) return;
  fluids.boundary.bodies.apply(local_boundary, particles);
  keep_out_of_bodies(fluids, particles);
}

}  // namespace

void Incompressibility::set_positions(const FluidInput& input, float h, FluidState& fluids) {
  InflowParticles& inflow = fluids.inflow;
  inflow.begin_substep(input, fluids.registry);
  const std::vector<std::uint32_t>& particle = fluids.registry.particle;
  positions_.resize(particle.size());
  start_.resize(particle.size());
  const Particles& particles = input.objects.particles;
  const ParticleView view = input.objects.view();
  const Vec3d origin = fluids.origin;
  const float radius = min_wall_distance * fluids.spacing;
  input.threads.each(particle.size(), density_grain, [&](std::size_t k) {
    const Vec4f& x = particles.position[particle[k]];
    const Vec3f at = Vec3f(Vec3d(x.xyz()) - origin) + particles.offset[particle[k]].xyz();
    start_[k] = Vec3f(view.exact_start(particle[k]) - origin);
    const Vec3d velocity(particles.velocity[particle[k]].xyz());
    const bool is_inflow = inflow.update(k, Vec3d(start_[k]) + origin, velocity);
    const Vec3f aim = is_inflow ? start_[k] + inflow.velocity(k) * h : at;
    const Vec3f kept = fluids.boundary.walls.keep_out(k, fluids.registry.fluid[k], start_[k], aim, radius);
    view.correct(particle[k], kept - at);
    positions_[k] = {kept.x, kept.y, kept.z, x.w};
  });
  fluids.solver->set_positions(positions_, input.threads);
}

void Incompressibility::sample_boundary(FluidState& fluids, Threads& threads) const {
  const float search_radius = LocalBoundary::search_radius(fluids.solver->smoothing());
  const auto order = fluids.solver->order();
  const auto x = fluids.solver->positions();
  const std::vector<std::uint16_t>& fluid = fluids.registry.fluid;
  const FluidBodies& bodies = fluids.boundary.bodies;
  fluids.boundary.local.gather(
      x.size(),
      [&](std::size_t k, std::vector<BoundaryPlane>& planes) {
        const std::uint32_t i = order[k];
        fluids.boundary.walls.find(i, fluid[i], x[k].xyz(), search_radius, planes);
        if (bodies.mesh_count() > 0) bodies.find(i, fluid[i], x[k].xyz(), start_[i], search_radius, planes);
      },
      threads);
}

void Incompressibility::solve(const FluidInput& input, const Substep& substep, FluidState& fluids) {
  Threads& threads = input.threads;
  FluidBoundary& boundary = fluids.boundary;
  input.warnings.guarded("a collider's motion",
                         [&] { boundary.walls.begin_substep(input.time, static_cast<double>(substep.h)); });
  set_positions(input, substep.h, fluids);
  DensitySolver& solver = *fluids.solver;
  const Smoothing& smoothing = solver.smoothing();
  const ParticleView particles = input.objects.view();
  if (boundary.bodies.mesh_count() > 0)
    boundary.bodies.begin_substep(particles, input.objects.particles.mass, positions_,
                                  LocalBoundary::search_radius(smoothing), threads);
  sample_boundary(fluids, threads);
  if (!boundary.sub_resolution.none())
    boundary.sub_resolution.find(solver.positions(), solver.order(), boundary.local, smoothing, particles,
                                 threads);
  Boundary of_solver{boundary.local, boundary.bodies, boundary.sub_resolution, smoothing};
  solver.solve(of_solver, threads, substep.h);
  apply_corrections(fluids, particles, threads);
}

}  // namespace souple
