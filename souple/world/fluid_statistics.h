#pragma once

#include "souple/fluid/density_solver.h"
#include "souple/fluid/local_boundary.h"
#include "souple/world/report.h"

#include <algorithm>
#include <cstddef>
#include <vector>

namespace souple {

/// What a step did to a world's fluids: density errors, pressures, forces on colliders.
class FluidStatistics {
 public:
  void begin_step(std::size_t particles);
  /// After the solver has pushed them in a substep of h seconds, one of `substeps`.
  void add_pressures(const DensitySolver& solver, const LocalBoundary& local_boundary, std::size_t colliders,
                     float h, int substeps, Threads& threads);
  /// The largest speed at its end [m/s], of particles a spacing [m] apart.
  void add_speed(double fastest, double h, double spacing);
  void add_viscosity_iterations(int iterations) { report_.viscosity_iterations += iterations; }

  /// Averages over substeps where that makes sense.
  FluidReport report() const;
  /// Of the fluids' k-th particle, mean of the substeps. [Pa]
  float pressure(std::size_t k) const;
  /// On a collider, mean of the substeps. [N]
  Vec3d force(std::size_t collider) const { return collider < force_.size() ? force_[collider] : Vec3d{}; }

 private:
  /// Of a chunk of places.
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
  std::vector<float> pressure_;        // of each particle, sum over substeps [Pa]
  std::vector<ChunkSums> chunk_sums_;  // of each chunk
  std::vector<Vec3d> push_sums_;       // of each chunk and collider
  std::vector<Vec3d> force_;           // on each collider [N]
};

}  // namespace souple
