#include "souple/fluid/air_drag.h"

namespace souple {

void apply_air_drag(const FluidView& fluid, std::span<const float> covered, const AirDrag& air, float h,
                    Threads& threads) {
  const Smoothing& smoothing = fluid.smoothing;
  const float d = smoothing.spacing();
  const float alone = smoothing.volume() * smoothing.center();
  const float strength = 0.5f * air.density * air.coefficient * d * d;  // kg/m
  for_each_index(fluid.size(), threads, [&](std::size_t k) {
    const float exposed = min(max((1 - covered[k]) / (1 - alone), 0.0f), 1.0f);
    const Vec3f wind = air.exposure.empty() ? air.wind : air.wind * air.exposure[k];
    const Vec3f against = fluid.v[k].xyz() - wind;
    // d|u|/dt = -s |u|^2:  |u| <- |u| / (1 + s |u| h)
    const float slowed = 1 / (1 + strength * exposed * fluid.x[k].w * h * length(against));
    fluid.v[k].set_xyz(wind + against * slowed);
  });
}

}  // namespace souple
