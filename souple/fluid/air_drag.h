#pragma once

#include "souple/fluid/fluid_view.h"

namespace souple {

/// What air does to a fluid's surface.
struct AirDrag {
  Vec3f wind{};               ///< [m/s]
  float density = 1.2f;       ///< of the air [kg/m^3]
  float coefficient = 0.47f;  ///< C; a ball's
};

/// Drag of the air, as on a drop of a particle's size, where it meets the air:
///
///   m dv/dt = e / 2 rho C d^2 |wind - v| (wind - v),   e = (1 - V sum W) / (1 - V W(0)) in [0, 1]
///
/// 0 within the fluid, about 0.2 at a flat surface, 1 for a drop alone. `covered` is V sum W, walls
/// included, by place. Solved exactly over h seconds: never more than the wind's speed.
void apply_air_drag(const FluidView& fluid, std::span<const float> covered, const AirDrag& air, float h,
                    Threads& threads);

}  // namespace souple
