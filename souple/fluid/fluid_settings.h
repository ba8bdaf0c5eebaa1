#pragma once

#include "souple/fluid/foam_parameters.h"
#include "souple/fluid/smoothing_shape.h"

namespace souple {

/// Solver of the incompressibility of fluids (docs/fluids.md).
struct FluidSettings {
  SmoothingShape kernel = SmoothingShape::wendland;
  /// Jacobi iterations after the coarse level, 0 to 100. With 0 a substep costs half; the residual is then
  /// added to the coarse level's pressure.
  int iterations = 1;
  /// > 0: further iterations, up to 50, until the mean density error is below this value.
  float tolerance = 0;
  float compressibility = 0;  ///< relative increase of density per pressure, >= 0 [1/Pa]
  /// Repulsive pressure between two particles that are 0.4 spacings apart, >= 0 [Pa]
  float artificial_pressure = 0;
  FoamParameters foam{};  ///< for fluids whose material has `foam` > 0
  friend bool operator==(const FluidSettings&, const FluidSettings&) = default;
};

}  // namespace souple
