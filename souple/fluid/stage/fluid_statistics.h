#pragma once

#include "souple/fluid/density_solver.h"
#include "souple/fluid/fluid_report.h"
#include "souple/fluid/local_boundary.h"

#include <algorithm>
#include <cstddef>
#include <vector>

namespace souple {

/// Statistics of a step for a world's fluids: density errors, pressures, forces on colliders.
class FluidStatistics {
 public:
  void begin_step(std::size_t particles);
  /// Adds the solver's result after a substep of h seconds, one of `substeps`.
  void add_pressures(const DensitySolver& solver, const LocalBoundary& local_boundary, std::size_t colliders,
                     float h, int substeps, Threads& threads);
  /// Adds the largest speed [m/s] at the end of a substep of h seconds; `spacing`: of the particles [m].
  void add_speed(double fastest, double h, double spacing);
  void add_viscosity_iterations(int iterations) { report_.viscosity_iterations += iterations; }

  /// The report; iteration counts are means over the substeps.
  FluidReport report() const;
  /// Pressure of the k-th fluid particle, mean over the substeps [Pa].
  float pressure(std::size_t k) const;
  /// Force on a collider, mean over the substeps [N].
  Vec3d force(std::size_t collider) const { return collider < force_.size() ? force_[collider] : Vec3d{}; }

 private:
  /// Sums and maxima of a chunk of sorted particles.
  struct ChunkSums {
    double errors = 0;
    float largest_error = 0, pressure = 0, coarsest = 0;

    void add(const ChunkSums& other) {
      errors += other.errors;
      largest_error = std::max(largest_error, other.largest_error);
      pressure = std::max(pressure, other.pressure);
      coarsest = std::max(coarsest, other.coarsest);
    }
  };

  ChunkSums sum_chunks(const DensitySolver& solver, const LocalBoundary& local_boundary,
                       std::size_t colliders, float h, Threads& threads);

  FluidReport report_;
  int substeps_ = 0;                   // so far
  std::vector<float> pressure_;        // per particle: sum over the substeps [Pa]
  std::vector<ChunkSums> chunk_sums_;  // per chunk
  std::vector<Vec3d> push_sums_;       // per chunk and collider
  std::vector<Vec3d> force_;           // per collider [N]
};

}  // namespace souple
