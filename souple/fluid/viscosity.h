#pragma once

#include "souple/fluid/implicit_viscosity.h"

namespace souple {

/// The viscosity of a fluid's material: explicit XSPH well below its stability limit, the implicit solve
/// above.
class Viscosity {
 public:
  explicit Viscosity(SmoothingShape shape = SmoothingShape::wendland,
                     const ImplicitViscosity::Options& options = {})
      : xsph_(shape), implicit_(shape, options) {}

  /// Whether a kinematic viscosity nu [m^2/s] needs the implicit solve over h seconds: h nu > 0.1 d^2.
  static bool is_implicit(float nu, float spacing, float h) { return h * nu > 0.1f * spacing * spacing; }

  /// Updates v by viscosity mu and wall friction over h seconds. Does nothing if mu is 0 everywhere.
  ImplicitViscosity::Report apply(const FluidView& fluid, WallFriction walls, float h, Threads& threads);

 private:
  Xsph xsph_;
  ImplicitViscosity implicit_;
};

}  // namespace souple
