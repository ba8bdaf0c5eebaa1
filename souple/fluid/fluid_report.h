#pragma once

#include <cstddef>

namespace souple {

/// Results of a step for fluids. Density errors are max(0, C) with C = rho / rho_0 - 1, before the last
/// correction of the last substep.
struct FluidReport {
  std::size_t particles = 0;
  std::size_t emitted = 0, drained = 0;  ///< particles added and removed before the step
  std::size_t held_back = 0;  ///< particles that an emitter could not add: blocked by fluid, or no capacity
  double mean_density_error = 0, largest_density_error = 0;
  double largest_pressure = 0;   ///< Pa
  double fastest = 0;            ///< largest speed [m/s]
  double largest_step = 0;       ///< max of h max(sqrt(p / rho), v / 1.5) / spacing; should be below a third
  double iterations = 0;         ///< Jacobi iterations, mean over the substeps
  double coarse_iterations = 0;  ///< conjugate gradient iterations for the pressure, mean over the substeps
  /// Conjugate gradient iterations for the viscosity, mean over the substeps; 0 if no system is solved.
  double viscosity_iterations = 0;
  std::size_t spray = 0, foam = 0, bubbles = 0;  ///< particles at the end of the step
};

}  // namespace souple
