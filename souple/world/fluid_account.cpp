#include "souple/world/fluid_account.h"

#include <algorithm>
#include <cmath>

namespace souple {

void FluidAccount::begin_step(std::size_t particles) {
  report_ = {};
  substeps_ = 0;
  force_.clear();
  pressure_.assign(particles, 0);
}

//   p_i = -lambda_i / (V h^2),   sqrt(p / rho) with rho = m / V
// Sums are of chunks, combined in order: the same for any number of threads.
FluidAccount::Noted FluidAccount::sum_up(const DensitySolver& solver, const LocalBoundary& local_boundary,
                                         std::size_t colliders, float h, Threads& threads) {
  constexpr std::size_t chunk_size = 2048;
  const std::size_t places = solver.size(), chunks = (places + chunk_size - 1) / chunk_size;
  const auto order = solver.order();
  const auto lambda = solver.lambda();
  const auto x = solver.positions();
  const float V = solver.smoothing().volume(), factor = -1 / (V * h * h);
  noted_.assign(chunks, {});
  pushed_.assign(chunks * colliders, {});
  threads.for_each(chunks, 1, [&](std::size_t first, std::size_t last) {
    for (std::size_t chunk = first; chunk < last; ++chunk) {
      Noted& noted = noted_[chunk];
      for (std::size_t k = chunk * chunk_size; k < std::min(places, (chunk + 1) * chunk_size); ++k) {
        const float p = lambda[k] * factor;
        pressure_[order[k]] += p;
        noted.pressure = std::max(noted.pressure, p);
        noted.coarsest = std::max(noted.coarsest, p * V * x[k].w);
        const float error = std::max(0.0f, solver.density_error(k));
        noted.errors += static_cast<double>(error);
        noted.largest_error = std::max(noted.largest_error, error);
        for (const BoundaryPlane& plane : local_boundary.of(k))
          if (plane.collider != BoundaryPlane::none)
            pushed_[chunk * colliders + plane.collider] += Vec3d(plane.push_sum);
      }
    }
  });
  Noted all;
  for (const Noted& noted : noted_) all.add(noted);
  return all;
}

// A push by slope lambda in a substep is an impulse of slope lambda / h on the particle.
void FluidAccount::note_pressures(const DensitySolver& solver, const LocalBoundary& local_boundary,
                                  std::size_t colliders, float h, int substeps, Threads& threads) {
  const Noted all = sum_up(solver, local_boundary, colliders, h, threads);
  const double H = h, spacing = solver.smoothing().spacing();
  force_.resize(colliders);
  for (std::size_t n = 0; n < pushed_.size(); ++n)
    force_[n % colliders] += pushed_[n] * (-1 / (H * H * substeps));
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

void FluidAccount::note_speed(double fastest, double h, double spacing) {
  report_.fastest = std::max(report_.fastest, fastest);
  report_.largest_step = std::max(report_.largest_step, fastest / 1.5 * h / spacing);
}

FluidReport FluidAccount::report() const {
  FluidReport report = report_;
  if (substeps_ > 0) {
    report.iterations /= substeps_;
    report.coarse_iterations /= substeps_;
    report.viscosity_iterations /= substeps_;
  }
  return report;
}

float FluidAccount::pressure(std::size_t k) const {
  return substeps_ > 0 ? pressure_[k] / static_cast<float>(substeps_) : 0.0f;
}

}  // namespace souple
