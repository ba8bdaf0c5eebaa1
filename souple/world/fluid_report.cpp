// What is told of a world's fluids: density errors, pressures, forces on colliders.

#include "souple/world/fluids.h"
#include "souple/world/state.h"

#include <algorithm>
#include <cmath>

namespace souple {

// A push by slope lambda in a substep is an impulse of slope lambda / h on the particle.
//   p_i = -lambda_i / (V h^2),   sqrt(p / rho) with rho = m / V
// Sums are of chunks, combined in order: the same for any number of threads.
void Fluids::note(const WorldState& world, const Substep& substep) {
  constexpr std::size_t chunk_size = 2048;
  const std::size_t places = solver_->size(), chunks = (places + chunk_size - 1) / chunk_size;
  const std::size_t colliders = world.tables.colliders.size();
  const auto order = solver_->order();
  const auto lambda = solver_->lambda();
  const auto x = solver_->positions();
  const float V = solver_->smoothing().volume(), factor = -1 / (V * substep.h * substep.h);
  noted_.assign(chunks, {});
  pushed_.assign(chunks * colliders, {});
  world.threads->for_each(chunks, 1, [&](std::size_t first, std::size_t last) {
    for (std::size_t chunk = first; chunk < last; ++chunk) {
      Noted& noted = noted_[chunk];
      for (std::size_t k = chunk * chunk_size; k < std::min(places, (chunk + 1) * chunk_size); ++k) {
        const float p = lambda[k] * factor;
        pressure_[order[k]] += p;
        noted.pressure = std::max(noted.pressure, p);
        noted.coarsest = std::max(noted.coarsest, p * V * x[k].w);
        const float error = std::max(0.0f, solver_->density_error(k));
        noted.errors += static_cast<double>(error);
        noted.largest_error = std::max(noted.largest_error, error);
        for (const NearPlane& plane : surroundings_.of(k))
          if (plane.collider != NearPlane::nobody)
            pushed_[chunk * colliders + plane.collider] += Vec3d(plane.pushed);
      }
    }
  });
  Noted all;
  for (const Noted& noted : noted_) all.add(noted);
  const auto h = static_cast<double>(substep.h);
  force_.resize(colliders);
  for (std::size_t n = 0; n < pushed_.size(); ++n)
    force_[n % colliders] += pushed_[n] * (-1 / (h * h * substep.count));
  ++substeps_;
  report_.particles = places;
  report_.mean_density_error = all.errors / static_cast<double>(places);
  report_.largest_density_error = static_cast<double>(all.largest_error);
  report_.largest_pressure = std::max(report_.largest_pressure, static_cast<double>(all.pressure));
  report_.coarse_iterations += solver_->coarse_iterations();
  report_.iterations += solver_->passes();
  report_.largest_step = std::max(
      report_.largest_step, std::sqrt(static_cast<double>(all.coarsest)) * h / static_cast<double>(spacing_));
}

FluidReport Fluids::report() const {
  FluidReport report = report_;
  foam_.report(report);
  if (substeps_ > 0)
    report.iterations /= substeps_, report.coarse_iterations /= substeps_,
        report.viscosity_iterations /= substeps_;
  return report;
}

Vec3d Fluids::force(std::size_t collider) const {
  return collider < force_.size() ? force_[collider] : Vec3d{};
}

float Fluids::pressure(std::uint32_t particle) const {
  const auto at = std::lower_bound(particle_.begin(), particle_.end(), particle);
  if (at == particle_.end() || *at != particle || substeps_ == 0) return 0;
  return pressure_[static_cast<std::size_t>(at - particle_.begin())] / static_cast<float>(substeps_);
}

}  // namespace souple
