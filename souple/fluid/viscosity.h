#pragma once

#include "souple/fluid/implicit_viscosity.h"

namespace souple {

/// The viscosity of a fluid's material, by what it takes: an exchange between neighbors where that is well
/// within what is stable, the implicit solve above it.
class Viscosity {
 public:
  explicit Viscosity(SmoothingShape shape = SmoothingShape::wendland,
                     const ImplicitViscosity::Options& options = {})
      : xsph_(shape), implicit_(shape, options) {}

  /// Whether h seconds of a kinematic viscosity nu [m^2/s] ask for the implicit solve: h nu > 0.1 d^2.
  static bool is_implicit(float nu, float spacing, float h) { return h * nu > 0.1f * spacing * spacing; }

  /// Changes v by what mu and walls say, over h seconds. Nothing happens where mu is 0.
  ImplicitViscosity::Report apply(const FluidView& fluid, WallFriction walls, float h, Threads& threads);

 private:
  Xsph xsph_;
  ImplicitViscosity implicit_;
};

}  // namespace souple
