#include "souple/fluid/viscosity.h"

#include <algorithm>

namespace souple {

ImplicitViscosity::Report Viscosity::apply(const FluidView& fluid, WallFriction walls, float h,
                                           Threads& threads) {
  float nu = 0;
  for (std::size_t k = 0; k < fluid.size(); ++k)
    nu = std::max(nu, fluid.v[k].w * fluid.x[k].w * fluid.smoothing.volume());
  if (nu == 0) return {};
  if (is_implicit(nu, fluid.smoothing.spacing(), h)) return implicit_.apply(fluid, walls, h, threads);
  xsph_.apply(fluid, walls, h, threads);
  return {};
}

}  // namespace souple
