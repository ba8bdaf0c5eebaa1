#include "souple/fluid/stage/foam_collisions.h"

#include "souple/contacts/contact_projector.h"
#include "souple/fluid/stage/fluid_input.h"
#include "souple/fluid/stage/fluid_state.h"
#include "souple/state/bytes.h"
#include "souple/state/warnings.h"

#include <algorithm>

namespace souple {

namespace {

/// of_each: per fluid, and within it per other object. result: per other object, whether any fluid collides with it.
void any_fluid(const std::vector<std::uint8_t>& of_each, std::size_t count,
               std::vector<std::uint8_t>& result) {
  result.assign(count, 0);
  for (std::size_t n = 0; n < of_each.size(); ++n) result[n % count] |= of_each[n];
}

}  // namespace

void FoamCollisions::begin_step(const FluidInput& input, const FoamInput& foam, const FluidState& fluids,
                                float gap) {
  gap_ = gap;
  find_walls(input, foam.dt, fluids);
  find_bodies(input, foam, fluids);
}

void FoamCollisions::find_walls(const FluidInput& input, double dt, const FluidState& fluids) {
  const std::vector<Collider>& colliders = input.contacts.colliders;
  any_fluid(fluids.registry.collides_with_collider, colliders.size(), collides_with_collider_);
  input.warnings.guarded("a collider's motion", [&] {
    walls_.begin_step(colliders, collides_with_collider_, fluids.origin, 0, input.time);
    walls_.begin_substep(input.time, dt);
  });
}

void FoamCollisions::find_bodies(const FluidInput& input, const FoamInput& foam, const FluidState& fluids) {
  const std::span<const BoundaryMesh> meshes = fluids.boundary.bodies.meshes();
  any_fluid(fluids.registry.collides_with_body, meshes.size(), collides_with_body_);
  bodies_.clear();
  for (std::size_t s = 0; s < meshes.size(); ++s)
    if (collides_with_body_[s] != 0) add_body(input, foam, meshes[s], fluids.origin);
  if (!bodies_.none()) bodies_.build(input.threads);
}

void FoamCollisions::add_body(const FluidInput& input, const FoamInput& foam, const BoundaryMesh& mesh,
                              const Vec3d& origin) {
  start_.resize(mesh.particles.size());
  end_.resize(mesh.particles.size());
  for_each_index(mesh.particles.size(), input.threads, [&](std::size_t v) {
    Vec3d before{}, after{};
    for (std::size_t k = 0; k < 4; ++k) {
      const std::uint32_t i = mesh.particles[v][k];
      const auto weight = static_cast<double>(mesh.weights[v][k]);
      if (weight == 0) continue;
      before += (Vec3d(foam.start_position[i].xyz()) + Vec3d(foam.start_offset[i].xyz()) - origin) * weight;
      after += (input.objects.particles.exact_position(i) - origin) * weight;
    }
    start_[v] = Vec3f(before);
    end_[v] = Vec3f(after);
  });
  for (const auto& [a, b, c] : mesh.triangles)
    bodies_.add({start_[a], start_[b], start_[c]}, {end_[a], end_[b], end_[c]}, mesh.half_thickness + gap_);
}

void FoamCollisions::keep_out(std::span<const Vec3f> start, std::span<Vec3f> x, std::span<Vec3f> v, float dt,
                              Threads& threads) {
  unconstrained_.assign(x.begin(), x.end());
  const auto out_of_walls = [&] {
    for_each_index(x.size(), threads, [&](std::size_t k) {
      if (is_finite(x[k])) x[k] = walls_.keep_out(0, start[k], x[k], gap_);
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

std::size_t FoamCollisions::bytes() const {
  return bodies_.bytes() + bytes_of(start_, end_, unconstrained_);
}

}  // namespace souple
