#include "souple/fluid/stage/fluid_forces.h"

#include "souple/fluid/air_drag.h"
#include "souple/fluid/stage/fluid_input.h"
#include "souple/fluid/stage/fluid_state.h"
#include "souple/fluid/stage/fluid_statistics.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace souple {

namespace {

struct Nearest {
  const BoundaryPlane* plane = nullptr;
  float distance = std::numeric_limits<float>::max();  // m
};

Nearest nearest_of(std::span<const BoundaryPlane> planes, const Vec3f& x) {
  Nearest nearest;
  for (const BoundaryPlane& plane : planes)
    if (const float distance = dot(plane.normal, x) - plane.offset; distance < nearest.distance)
      nearest = {&plane, distance};
  return nearest;
}

float max_of(const std::vector<FluidMaterial>& materials, float FluidMaterial::*value) {
  float result = 0;
  for (const FluidMaterial& material : materials) result = std::max(result, material.*value);
  return result;
}

}  // namespace

FluidView FluidForces::view(const DensitySolver& solver) {
  return {solver.padded_positions(), velocity_, solver.neighbors(), solver.smoothing()};
}

// Combines several walls as if they occluded one another. Friction with kinematic walls is applied here;
// BodyFriction handles movable bodies.
void FluidForces::find_wall_friction(float h, FluidState& fluids, Threads& threads) {
  const DensitySolver& solver = *fluids.solver;
  LocalBoundary& local_boundary = fluids.boundary.local;
  const auto x = solver.positions();
  const auto order = solver.order();
  wall_friction_.resize(x.size());
  for_each_index(x.size(), threads, [&](std::size_t k) {
    Vec3f motion{};
    float sum = 0, kinematic = 0, left = 1;
    for (BoundaryPlane& plane : local_boundary.of(k)) {
      plane.friction =
          part_of(solver.smoothing().wall(dot(plane.normal, x[k].xyz()) - plane.offset), plane.share).value;
      sum += plane.friction;
      left *= 1 - plane.friction;
      if (fluids.boundary.bodies.is_movable(plane)) continue;
      motion += plane.motion * plane.friction;
      kinematic += plane.friction;
    }
    const Vec3f speed = kinematic > 0 ? motion * (1 / (kinematic * h)) : Vec3f{};
    const float all = (1 - left) * fluids.registry.materials[fluids.registry.fluid[order[k]]].friction;
    const float share = sum > 0 ? all / sum : 0;
    for (BoundaryPlane& plane : local_boundary.of(k)) plane.friction *= share;
    wall_friction_[k] = {speed.x, speed.y, speed.z, kinematic == sum ? all : kinematic * share};
  });
}

void FluidForces::find_near_walls(const FluidState& fluids, Threads& threads) {
  const auto x = fluids.solver->positions();
  near_walls_.resize(x.size());
  for_each_index(x.size(), threads, [&](std::size_t k) {
    const Nearest nearest = nearest_of(fluids.boundary.local.of(k), x[k].xyz());
    near_walls_[k] = nearest.plane ? NearWall{nearest.plane->normal, nearest.distance} : NearWall{};
  });
}

// Reaction of the fluid's adhesion on the nearest body.
void FluidForces::apply_adhesion(const FluidInput& input, const FluidState& fluids) const {
  Particles& particles = input.objects.particles;
  const FluidBodies& bodies = fluids.boundary.bodies;
  const auto x = fluids.solver->positions();
  const auto pulls = surface_tension_.wall_pulls();
  for (std::size_t k = 0; k < x.size(); ++k) {
    const Nearest nearest = nearest_of(fluids.boundary.local.of(k), x[k].xyz());
    if (nearest.plane && bodies.is_movable(*nearest.plane))
      push_carriers(bodies, *nearest.plane, nearest.plane->normal * pulls[k], particles.velocity,
                    particles.position);
  }
}

void FluidForces::apply_surface_tension(const FluidInput& input, float sigma, float h,
                                        const FluidState& fluids) {
  find_near_walls(fluids, input.threads);
  const float angle = fluids.registry.materials[0].contact_angle * static_cast<float>(pi) / 180;
  surface_tension_.apply(view(*fluids.solver), near_walls_, {sigma, SurfaceTension::adhesion_of(angle)}, h,
                         input.threads);
  if (fluids.boundary.bodies.mesh_count() > 0) apply_adhesion(input, fluids);
}

void FluidForces::apply_air(const FluidInput& input, const FluidAir& air, float coefficient, float h,
                            const FluidState& fluids) {
  const FluidView view = this->view(*fluids.solver);
  const auto order = fluids.solver->order();
  density_ratio_.resize(view.size());
  wind_exposure_.resize(view.size());
  for_each_index(view.size(), input.threads, [&](std::size_t k) {
    density_ratio_[k] = 1 + fluids.solver->density_error(k);
    wind_exposure_[k] = fluids.registry.wind_exposures[fluids.registry.fluid[order[k]]];
  });
  apply_air_drag(view, density_ratio_, {air.wind, air.density, coefficient, wind_exposure_}, h,
                 input.threads);
}

// For all fluids the largest value of their materials applies. Exceptions: viscosity, body drag and exposure to
// wind are per fluid; the contact angle is that of the first fluid.
void FluidForces::apply_forces(const FluidInput& input, const FluidAir& air, float h, FluidState& fluids,
                               FluidStatistics& statistics) {
  Threads& threads = input.threads;
  Particles& particles = input.objects.particles;
  FluidBoundary& boundary = fluids.boundary;
  const std::vector<FluidMaterial>& materials = fluids.registry.materials;
  const FluidView view = this->view(*fluids.solver);
  find_wall_friction(h, fluids, threads);
  const ImplicitViscosity::Report viscous = viscosity_.apply(view, wall_friction_, h, threads);
  statistics.add_viscosity_iterations(viscous.iterations);
  if (boundary.bodies.mesh_count() > 0)
    body_friction_.apply(view, boundary.local, boundary.bodies, h, particles.velocity, particles.position,
                         threads);
  if (!boundary.sub_resolution.none())
    boundary.sub_resolution.drag(view, fluids.solver->order(), fluids.registry.viscosities, h,
                                 particles.velocity, particles.position, threads);
  if (const float sigma = max_of(materials, &FluidMaterial::surface_tension); sigma > 0)
    apply_surface_tension(input, sigma, h, fluids);
  if (const float epsilon = max_of(materials, &FluidMaterial::vorticity); epsilon > 0)
    vorticity_.apply(view, epsilon, h, threads);
  if (const float coefficient = max_of(materials, &FluidMaterial::air_drag); coefficient > 0)
    apply_air(input, air, coefficient, h, fluids);
}

// XSPH as a viscosity: a rate c corresponds to nu = c m2 / 6, m2 = 6 d^2 wall(d/2).value; see xsph.h.
void FluidForces::load_velocities(const FluidInput& input, const FluidState& fluids) {
  const auto order = fluids.solver->order();
  const FluidRegistry& registry = fluids.registry;
  const std::span<const Vec4f> velocity = input.objects.particles.velocity;
  velocity_.resize(order.size() + 1);
  velocity_.back() = {};
  const float exchange =
      fluids.spacing * fluids.spacing * fluids.solver->smoothing().wall(fluids.spacing / 2).value;
  for_each_index(order.size(), input.threads, [&](std::size_t k) {
    const std::uint32_t i = order[k];
    const FluidMaterial& material = registry.materials[registry.fluid[i]];
    velocity_[k] = velocity[registry.particle[i]];
    if (fluids.inflow.is_inflow(i)) velocity_[k].set_xyz(fluids.inflow.velocity(i));
    velocity_[k].w = material.viscosity + material.density * material.xsph * exchange;
  });
}

void FluidForces::store_velocities(const FluidInput& input, const FluidState& fluids) const {
  const auto order = fluids.solver->order();
  const std::span<Vec4f> velocity = input.objects.particles.velocity;
  for_each_index(order.size(), input.threads, [&](std::size_t k) {
    const std::uint32_t i = order[k];
    velocity[fluids.registry.particle[i]].set_xyz(fluids.inflow.is_inflow(i) ? fluids.inflow.velocity(i)
                                                                             : velocity_[k].xyz());
  });
}

double FluidForces::max_speed() const {
  double fastest = 0;
  for (std::size_t k = 0; k + 1 < velocity_.size(); ++k)
    fastest = std::max(fastest, static_cast<double>(length_squared(velocity_[k].xyz())));
  return std::sqrt(fastest);
}

void FluidForces::apply(const FluidInput& input, const FluidAir& air, float h, FluidState& fluids,
                        FluidStatistics& statistics) {
  load_velocities(input, fluids);
  apply_forces(input, air, h, fluids, statistics);
  statistics.add_speed(max_speed(), static_cast<double>(h), static_cast<double>(fluids.spacing));
  store_velocities(input, fluids);
}

}  // namespace souple
