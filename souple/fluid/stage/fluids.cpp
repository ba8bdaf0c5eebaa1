#include "souple/fluid/stage/fluids.h"

#include "souple/contacts/contact_projector.h"
#include "souple/fluid/fluid_settings.h"
#include "souple/fluid/stage/fluid_foam.h"
#include "souple/fluid/stage/fluid_forces.h"
#include "souple/fluid/stage/fluid_input.h"
#include "souple/fluid/stage/fluid_state.h"
#include "souple/fluid/stage/fluid_statistics.h"
#include "souple/fluid/stage/incompressibility.h"
#include "souple/state/warnings.h"

#include <algorithm>
#include <cmath>

namespace souple {

namespace {

/// Origin of a fluid's coordinates: floats far from it are coarse. It is a multiple of one meter or, for
/// spacings below 2 mm, of a power of two of at least 256 spacings.
Vec3d origin_near(const Vec3d& x, float spacing) {
  const double cell = min(1.0, std::ldexp(1.0, std::ilogb(256 * double{spacing}) + 1));
  return {std::floor(x.x / cell) * cell, std::floor(x.y / cell) * cell, std::floor(x.z / cell) * cell};
}

DensitySolver::Options options_of(const FluidSettings& settings) {
  return {.shape = settings.kernel,
          .passes = settings.iterations,
          .tolerance = settings.tolerance,
          .compressibility = settings.compressibility,
          .artificial_pressure = settings.artificial_pressure};
}

}  // namespace

struct Fluids::Parts {
  FluidState state;
  DensitySolver::Options options;  // of state.solver
  Incompressibility incompressibility;
  FluidForces forces;
  FluidFoam foam;
  FluidStatistics statistics;

  void choose_solver(const FluidSettings& settings);
  void begin_boundary(const FluidInput& input);
};

Fluids::Fluids() : parts_(std::make_unique<Parts>()) {}
Fluids::~Fluids() = default;

void Fluids::build(const ObjectsView& objects) {
  FluidState& fluids = parts_->state;
  fluids.registry.find_bodies(objects, fluids.boundary.bodies, fluids.boundary.sub_resolution);
}

bool Fluids::none() const {
  return parts_->state.registry.particle.empty();
}

void Fluids::begin_step(const FluidInput& input, double dt) {
  FluidState& fluids = parts_->state;
  FluidRegistry& registry = fluids.registry;
  registry.find_particles(input.objects, input.contacts);
  parts_->statistics.begin_step(registry.particle.size());
  if (none()) return;
  fluids.inflow.begin_step(input, registry, dt);
  parts_->choose_solver(input.settings);
  fluids.solver->begin_step();
  fluids.origin = origin_near(input.objects.particles.exact_position(registry.particle[0]), fluids.spacing);
  parts_->begin_boundary(input);
}

void Fluids::Parts::begin_boundary(const FluidInput& input) {
  FluidBoundary& boundary = state.boundary;
  const FluidRegistry& registry = state.registry;
  boundary.bodies.begin_step(registry.collides_with_body, state.origin);
  boundary.sub_resolution.begin_step(registry.collides_with_sub_resolution, registry.sub_resolution.size(),
                                     registry.fluid, state.origin);
  input.warnings.guarded("a collider's motion", [&] {
    boundary.walls.begin_step(input.contacts.colliders, registry.collides_with_collider, state.origin,
                              registry.particle.size(), input.time);
  });
}

void Fluids::Parts::choose_solver(const FluidSettings& settings) {
  const float spacing = state.registry.materials[0].spacing;
  const DensitySolver::Options wanted = options_of(settings);
  if (state.solver && state.spacing == spacing && options == wanted) return;
  state.solver = std::make_unique<DensitySolver>(spacing, wanted);
  state.spacing = spacing;
  forces = FluidForces(wanted.shape);
  options = wanted;
}

void Fluids::settle(const FluidInput& input, const Substep& substep) {
  constexpr int rounds = 10;
  Particles& particles = input.objects.particles;
  const std::vector<Vec4f> predicted = particles.offset, before = particles.start;
  for (int round = 0; round < rounds; ++round) {
    for (std::size_t i = 0; i < particles.size(); ++i) particles.offset[i].set_xyz(particles.start[i].xyz());
    parts_->incompressibility.solve(input, substep, parts_->state);
    for (const std::uint32_t i : parts_->state.registry.particle)
      particles.start[i].set_xyz(particles.offset[i].xyz());
  }
  for (std::size_t i = 0; i < particles.size(); ++i)
    particles.offset[i].set_xyz(predicted[i].xyz() + (particles.start[i].xyz() - before[i].xyz()));
}

void Fluids::solve_incompressibility(const FluidInput& input, const Substep& substep) {
  FluidState& fluids = parts_->state;
  parts_->incompressibility.solve(input, substep, fluids);
  parts_->statistics.add_pressures(*fluids.solver, fluids.boundary.local, input.contacts.colliders.size(),
                                   substep.h, substep.count, input.threads);
}

void Fluids::update_velocities(const FluidInput& input, const FluidAir& air, const Substep& substep) {
  parts_->forces.apply(input, air, substep.h, parts_->state, parts_->statistics);
}

void Fluids::step_foam(const FluidInput& input, const FoamInput& foam_input) {
  FluidState& fluids = parts_->state;
  FluidFoam& foam = parts_->foam;
  const std::vector<FluidMaterial>& materials = fluids.registry.materials;
  const bool foams = std::any_of(materials.begin(), materials.end(),
                                 [](const FluidMaterial& material) { return material.foam > 0; });
  if (none() || (!foams && foam.size() == 0)) return foam.clear();
  foam.step(input, foam_input, fluids, parts_->forces.view(*fluids.solver));
}

const FluidFoam& Fluids::foam() const {
  return parts_->foam;
}

FluidFoam& Fluids::foam() {
  return parts_->foam;
}

FluidReport Fluids::report() const {
  FluidReport report = parts_->statistics.report();
  parts_->foam.report(report);
  return report;
}

float Fluids::pressure(std::uint32_t particle) const {
  const std::vector<std::uint32_t>& particles = parts_->state.registry.particle;
  const auto at = std::lower_bound(particles.begin(), particles.end(), particle);
  if (at == particles.end() || *at != particle) return 0;
  return parts_->statistics.pressure(static_cast<std::size_t>(at - particles.begin()));
}

void Fluids::store_pressures(std::span<Vec4f> velocity) const {
  const std::vector<std::uint32_t>& particles = parts_->state.registry.particle;
  for (std::size_t k = 0; k < particles.size(); ++k)
    velocity[particles[k]].w = parts_->statistics.pressure(k);
}

Vec3d Fluids::force(std::size_t collider) const {
  return parts_->statistics.force(collider);
}

}  // namespace souple
