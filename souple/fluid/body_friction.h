#pragma once

#include "souple/fluid/fluid_bodies.h"
#include "souple/fluid/fluid_view.h"

#include <span>
#include <vector>

namespace souple {

/// Friction between fluids and movable bodies. A particle i and the nearest point of a body exchange equal
/// and opposite impulses
///
///   F = k (u - v_i) / (1 + max_p K_p w_p),   k = r m / (m + R),   K_p = sum_i share_ip k_i
///
/// Here r = h V mu wall_friction(BoundaryPlane::friction) is the impulse per velocity that a wall would take from the
/// particle (see xsph.h). R is the sum of r over all bodies near the particle, u the velocity of the nearest point.
/// The particles p carry this point. k is the implicit step of the fluid particle. K_p, the sum over all fluid
/// particles that act on p, bounds the step of the body. p moves at most by the fraction K_p w_p / (1 + K_p w_p) toward
/// the fluid's velocity. So neither side overshoots, however light the body is.
class BodyFriction {
 public:
  /// Applies friction over h seconds; BoundaryPlane::friction must be set, and is overwritten by k [kg].
  /// `velocity` [m/s] and `inverse_mass` (w, [1/kg]) belong to the world's particles.
  void apply(const FluidView& fluid, LocalBoundary& local_boundary, const FluidBodies& bodies, float h,
             std::span<Vec4f> velocity, std::span<const Vec4f> inverse_mass, Threads& threads);

 private:
  void find_coupling(const FluidView& fluid, LocalBoundary& local_boundary, const FluidBodies& bodies,
                     float h, Threads& threads);

  std::vector<float> coupling_;  // K_p per particle of the world [kg]
};

/// Applies an impulse [kg m/s] at a plane's nearest point to the particles that carry this point.
void push_carriers(const FluidBodies& bodies, const BoundaryPlane& plane, const Vec3f& impulse,
                   std::span<Vec4f> velocity, std::span<const Vec4f> inverse_mass);

}  // namespace souple
