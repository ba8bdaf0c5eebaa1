#include "souple/fluid/stage/fluid_statistics.h"

#include <algorithm>
#include <cmath>

namespace souple {

void FluidStatistics::begin_step(std::size_t particles) {
  report_ = {};
  substeps_ = 0;
  force_.clear();
  pressure_.assign(particles, 0);
}

// p_i = -lambda_i / (V h^2),   sqrt(p / rho) with rho = m / V
// Sums are made of chunks and combined in order: the same for any number of threads.
FluidStatistics::ChunkSums FluidStatistics::sum_chunks(const DensitySolver& solver,
                                                       const LocalBoundary& local_boundary,
                                                       std::size_t colliders, float h, Threads& threads) {
  constexpr std::size_t chunk_size = 2048;
  const std::size_t count = solver.size(), chunks = (count + chunk_size - 1) / chunk_size;
  const auto order = solver.order();
  const auto lambda = solver.lambda();
  const auto x = solver.positions();
  const float V = solver.smoothing().volume(), factor = -1 / (V * h * h);
  chunk_sums_.assign(chunks, {});
  push_sums_.assign(chunks * colliders, {});
  threads.each(chunks, 1, [&](std::size_t chunk) {
    ChunkSums& sums = chunk_sums_[chunk];
    for (std::size_t k = chunk * chunk_size; k < std::min(count, (chunk + 1) * chunk_size); ++k) {
      const float p = lambda[k] * factor;
      pressure_[order[k]] += p;
      sums.pressure = std::max(sums.pressure, p);
      sums.coarsest = std::max(sums.coarsest, p * V * x[k].w);
      const float error = std::max(0.0f, solver.density_error(k));
      sums.errors += static_cast<double>(error);
      sums.largest_error = std::max(sums.largest_error, error);
      for (const BoundaryPlane& plane : local_boundary.of(k))
        if (plane.collider != BoundaryPlane::none)
          push_sums_[chunk * colliders + plane.collider] += Vec3d(plane.push_sum);
    }
  });
  ChunkSums all;
  for (const ChunkSums& sums : chunk_sums_) all.add(sums);
  return all;
}

// A push with slope lambda in a substep is an impulse of slope lambda / h on the particle.
void FluidStatistics::add_pressures(const DensitySolver& solver, const LocalBoundary& local_boundary,
                                    std::size_t colliders, float h, int substeps, Threads& threads) {
  const ChunkSums all = sum_chunks(solver, local_boundary, colliders, h, threads);
  const double H = h, spacing = solver.smoothing().spacing();
  force_.resize(colliders);
  for (std::size_t n = 0; n < push_sums_.size(); ++n)
    force_[n % colliders] += push_sums_[n] * (-1 / (H * H * substeps));
  ++substeps_;
  report_.particles = solver.size();
  report_.mean_density_error = all.errors / static_cast<double>(solver.size());
  report_.largest_density_error = static_cast<double>(all.largest_error);
  report_.largest_pressure = std::max(report_.largest_pressure, static_cast<double>(all.pressure));
  report_.coarse_iterations += solver.coarse_iterations();
  report_.iterations += solver.passes();
  report_.largest_step =
      std::max(report_.largest_step, std::sqrt(static_cast<double>(all.coarsest)) * H / spacing);
}

void FluidStatistics::add_speed(double fastest, double h, double spacing) {
  report_.fastest = std::max(report_.fastest, fastest);
  report_.largest_step = std::max(report_.largest_step, fastest / 1.5 * h / spacing);
}

FluidReport FluidStatistics::report() const {
  FluidReport report = report_;
  if (substeps_ > 0) {
    report.iterations /= substeps_;
    report.coarse_iterations /= substeps_;
    report.viscosity_iterations /= substeps_;
  }
  return report;
}

float FluidStatistics::pressure(std::size_t k) const {
  return substeps_ > 0 ? pressure_[k] / static_cast<float>(substeps_) : 0.0f;
}

}  // namespace souple
