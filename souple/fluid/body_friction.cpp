#include "souple/fluid/body_friction.h"

#include "souple/fluid/xsph.h"

#include <algorithm>

namespace souple {

void push_carriers(const FluidBodies& bodies, const BoundaryPlane& plane, const Vec3f& impulse,
                   std::span<Vec4f> velocity, std::span<const Vec4f> inverse_mass) {
  bodies.for_carriers(plane, [&](std::uint32_t p, float share) {
    velocity[p].set_xyz(velocity[p].xyz() + impulse * (share * inverse_mass[p].w));
  });
}

// Replaces BoundaryPlane::friction by k [kg].
void BodyFriction::find_coupling(const FluidView& fluid, LocalBoundary& local_boundary,
                                 const FluidBodies& bodies, float h, Threads& threads) {
  for_each_index(fluid.size(), threads, [&](std::size_t k) {
    const float viscous = h * fluid.smoothing.volume() * fluid.v[k].w;
    float all = 0;
    for (BoundaryPlane& plane : local_boundary.of(k)) {
      plane.friction =
          bodies.is_movable(plane) ? viscous * wall_friction(fluid.smoothing, plane.friction) : 0;
      all += plane.friction;
    }
    for (BoundaryPlane& plane : local_boundary.of(k)) plane.friction /= 1 + all * fluid.x[k].w;
  });
  const auto for_movable_planes = [&](const auto& f) {
    for (std::size_t k = 0; k < fluid.size(); ++k)
      for (const BoundaryPlane& plane : local_boundary.of(k))
        if (plane.friction > 0)
          bodies.for_carriers(plane, [&](std::uint32_t p, float share) { f(plane, p, share); });
  };
  for_movable_planes([&](const BoundaryPlane&, std::uint32_t p, float) { coupling_[p] = 0; });
  for_movable_planes([&](const BoundaryPlane& plane, std::uint32_t p, float share) {
    coupling_[p] += share * plane.friction;
  });
}

void BodyFriction::apply(const FluidView& fluid, LocalBoundary& local_boundary, const FluidBodies& bodies,
                         float h, std::span<Vec4f> velocity, std::span<const Vec4f> inverse_mass,
                         Threads& threads) {
  coupling_.resize(velocity.size());
  find_coupling(fluid, local_boundary, bodies, h, threads);
  for_each_index(fluid.size(), threads, [&](std::size_t k) {
    const Vec3f before = fluid.v[k].xyz();
    Vec3f gained{};
    for (BoundaryPlane& plane : local_boundary.of(k)) {
      if (!(plane.friction > 0)) continue;
      Vec3f speed{};
      float bound = 0;
      bodies.for_carriers(plane, [&](std::uint32_t p, float share) {
        speed += velocity[p].xyz() * share;
        bound = std::max(bound, coupling_[p] * inverse_mass[p].w);
      });
      const Vec3f impulse = (speed - before) * (plane.friction / (1 + bound));
      plane.friction_impulse = -impulse;
      gained += impulse;
    }
    fluid.v[k].set_xyz(before + gained * fluid.x[k].w);
  });
  for (std::size_t k = 0; k < fluid.size(); ++k)
    for (const BoundaryPlane& plane : local_boundary.of(k))
      if (plane.friction > 0) push_carriers(bodies, plane, plane.friction_impulse, velocity, inverse_mass);
}

}  // namespace souple
