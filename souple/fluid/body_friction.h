#pragma once

#include "souple/fluid/fluid_bodies.h"
#include "souple/fluid/fluid_view.h"

#include <span>
#include <vector>

namespace souple {

/// Friction between fluids and bodies that something can move. A particle i and the point of a body that it
/// touches exchange an impulse, equal and opposite,
///
///   F = k (u - v_i) / (1 + max_p K_p w_p),   k = r m / (m + R),   K_p = sum_i share_ip k_i
///
/// with r = h V mu wall_friction(hold) what the particle would lose to a wall (see xsph.h), R the sum over
/// all that it touches, u the point's velocity, p the particles that carry it. k is the implicit step of the
/// fluid's particle; the sum K_p over all that rub on p makes that of the body a bound: p goes
/// K_p w_p / (1 + K_p w_p) of the way to what rubs on it at most. So neither overshoots, be the body as light
/// as it will.
class BodyFriction {
 public:
  /// Over h seconds; BoundaryPlane::hold is known. `velocity` [m/s] and `inverse_mass` (w, [1/kg]) of the world's
  /// particles.
  void apply(const FluidView& fluid, LocalBoundary& local_boundary, const FluidBodies& bodies, float h,
             std::span<Vec4f> velocity, std::span<const Vec4f> inverse_mass, Threads& threads);

 private:
  void find_coupling(const FluidView& fluid, LocalBoundary& local_boundary, const FluidBodies& bodies,
                     float h, Threads& threads);

  std::vector<float> coupling_;  // K_p of the world's particles [kg]
};

/// An impulse [kg m/s] at the point a plane touches goes to those that carry it.
void push_carriers(const FluidBodies& bodies, const BoundaryPlane& plane, const Vec3f& impulse,
                   std::span<Vec4f> velocity, std::span<const Vec4f> inverse_mass);

}  // namespace souple
