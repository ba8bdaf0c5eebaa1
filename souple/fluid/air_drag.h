#pragma once

#include "souple/fluid/fluid_view.h"

namespace souple {

/// The air around a fluid.
struct AirDrag {
  Vec3f wind{};               ///< wind velocity [m/s]
  float density = 1.2f;       ///< density of the air [kg/m^3]
  float coefficient = 0.47f;  ///< drag coefficient C; 0.47 is that of a ball
  /// Per sorted index: share of the wind's velocity that reaches the particle; empty: 1.
  std::span<const float> exposure{};
};

/// Air drag on surface particles, each treated as a drop of one particle's size:
///
///   m dv/dt = e / 2 rho C d^2 |wind - v| (wind - v),   e = (1 - V sum W) / (1 - V W(0)) in [0, 1]
///
/// The exposure e is 0 inside the fluid, about 0.2 at a flat surface and 1 for a single drop. `covered` is V
/// sum W per sorted index, walls included. The equation is solved exactly over h seconds, so v never passes
/// the wind's velocity.
void apply_air_drag(const FluidView& fluid, std::span<const float> covered, const AirDrag& air, float h,
                    Threads& threads);

}  // namespace souple
