#include "souple/fluid/air_drag.h"
#include "souple/stages/forces.h"
#include "souple/world/fluids.h"
#include "souple/world/state.h"

// Forces on a world's fluids: viscosity, wall friction, surface tension, vorticity confinement, air drag.

#include <algorithm>
#include <cmath>
#include <limits>

namespace souple {

// Combines several walls as if they occluded one another. Friction with kinematic walls is applied here;
// BodyFriction handles movable bodies.
void Fluids::find_wall_friction(float h, Threads& threads) {
  const auto x = solver_->positions();
  const auto order = solver_->order();
  wall_friction_.resize(x.size());
  for_each_index(x.size(), threads, [&](std::size_t k) {
    Vec3f motion{};
    float sum = 0, kinematic = 0, left = 1;
    for (BoundaryPlane& plane : local_boundary_.of(k)) {
      plane.friction =
          part_of(solver_->smoothing().wall(dot(plane.normal, x[k].xyz()) - plane.offset), plane.share).value;
      sum += plane.friction;
      left *= 1 - plane.friction;
      if (bodies_.is_movable(plane)) continue;
      motion += plane.motion * plane.friction;
      kinematic += plane.friction;
    }
    const Vec3f speed = kinematic > 0 ? motion * (1 / (kinematic * h)) : Vec3f{};
    const float all = (1 - left) * registry_.materials[registry_.fluid[order[k]]].friction;
    const float share = sum > 0 ? all / sum : 0;
    for (BoundaryPlane& plane : local_boundary_.of(k)) plane.friction *= share;
    wall_friction_[k] = {speed.x, speed.y, speed.z, kinematic == sum ? all : kinematic * share};
  });
}

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

}  // namespace

void Fluids::find_near_walls(Threads& threads) {
  const auto x = solver_->positions();
  near_walls_.resize(x.size());
  for_each_index(x.size(), threads, [&](std::size_t k) {
    const Nearest nearest = nearest_of(local_boundary_.of(k), x[k].xyz());
    near_walls_[k] = nearest.plane ? NearWall{nearest.plane->normal, nearest.distance} : NearWall{};
  });
}

// Reaction of the fluid's adhesion on the nearest body.
void Fluids::apply_adhesion(WorldState& world) {
  const auto x = solver_->positions();
  const auto pulls = surface_tension_.wall_pulls();
  for (std::size_t k = 0; k < x.size(); ++k) {
    const Nearest nearest = nearest_of(local_boundary_.of(k), x[k].xyz());
    if (nearest.plane && bodies_.is_movable(*nearest.plane))
      push_carriers(bodies_, *nearest.plane, nearest.plane->normal * pulls[k], world.particles.velocity,
                    world.particles.position);
  }
}

// For all fluids the largest value of their materials applies. Exceptions: viscosity, body drag and exposure to
// wind are per fluid; the contact angle is that of the first fluid.
void Fluids::apply_forces(WorldState& world, const Substep& substep) {
  Threads& threads = *world.threads;
  const FluidView view = this->view();
  const auto max_of = [&](float FluidMaterial::*value) {
    float result = 0;
    for (const FluidMaterial& material : registry_.materials) result = std::max(result, material.*value);
    return result;
  };
  find_wall_friction(substep.h, threads);
  const ImplicitViscosity::Report viscous = viscosity_.apply(view, wall_friction_, substep.h, threads);
  statistics_.add_viscosity_iterations(viscous.iterations);
  if (bodies_.mesh_count() > 0)
    body_friction_.apply(view, local_boundary_, bodies_, substep.h, world.particles.velocity,
                         world.particles.position, threads);
  if (!sub_resolution_bodies_.none())
    sub_resolution_bodies_.drag(view, solver_->order(), registry_.viscosities, substep.h,
                                world.particles.velocity, world.particles.position, threads);
  if (const float sigma = max_of(&FluidMaterial::surface_tension); sigma > 0) {
    find_near_walls(threads);
    const float angle = registry_.materials[0].contact_angle * static_cast<float>(pi) / 180;
    surface_tension_.apply(view, near_walls_, {sigma, SurfaceTension::adhesion_of(angle)}, substep.h,
                           threads);
    if (bodies_.mesh_count() > 0) apply_adhesion(world);
  }
  if (const float epsilon = max_of(&FluidMaterial::vorticity); epsilon > 0)
    vorticity_.apply(view, epsilon, substep.h, threads);
  if (const float coefficient = max_of(&FluidMaterial::air_drag); coefficient > 0) {
    const auto order = solver_->order();
    density_ratio_.resize(view.size());
    wind_exposure_.resize(view.size());
    for_each_index(view.size(), threads, [&](std::size_t k) {
      density_ratio_[k] = 1 + solver_->density_error(k);
      wind_exposure_[k] = registry_.wind_exposures[registry_.fluid[order[k]]];
    });
    const AirDrag air{wind_at(world.settings, world.time), world.settings.wind.air_density, coefficient,
                      wind_exposure_};
    apply_air_drag(view, density_ratio_, air, substep.h, threads);
  }
}

// XSPH as a viscosity: a rate c corresponds to nu = c m2 / 6, m2 = 6 d^2 wall(d/2).value; see xsph.h.
void Fluids::update_velocities(WorldState& world, const Substep& substep) {
  Threads& threads = *world.threads;
  const auto order = solver_->order();
  std::vector<Vec4f>& velocity = world.particles.velocity;
  velocity_.resize(order.size() + 1);
  velocity_.back() = {};
  const float exchange = spacing_ * spacing_ * solver_->smoothing().wall(spacing_ / 2).value;
  for_each_index(order.size(), threads, [&](std::size_t k) {
    const FluidMaterial& material = registry_.materials[registry_.fluid[order[k]]];
    velocity_[k] = velocity[registry_.particle[order[k]]];
    if (inflow_.is_inflow(order[k])) velocity_[k].set_xyz(inflow_.velocity(order[k]));
    velocity_[k].w = material.viscosity + material.density * material.xsph * exchange;
  });
  apply_forces(world, substep);
  double fastest = 0;
  for (std::size_t k = 0; k < order.size(); ++k)
    fastest = std::max(fastest, static_cast<double>(length_squared(velocity_[k].xyz())));
  statistics_.add_speed(std::sqrt(fastest), static_cast<double>(substep.h), static_cast<double>(spacing_));
  for_each_index(order.size(), threads, [&](std::size_t k) {
    const std::uint32_t i = order[k];
    velocity[registry_.particle[i]].set_xyz(inflow_.is_inflow(i) ? inflow_.velocity(i) : velocity_[k].xyz());
  });
}

}  // namespace souple
