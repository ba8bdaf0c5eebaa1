#include "souple/studies/chebyshev.h"

#include "souple/solver/facets.h"

#include <algorithm>

namespace souple {

void Chebyshev::begin(std::span<Projector* const> projectors, const ParticleView& particles) {
  iteration_ = 0;
  omega_ = 1;
  begin(particles.moving, moving_);
  std::size_t arrays = 0;
  for (Projector* projector : projectors)
    projector->facets().study->multipliers([&](std::span<float> lambda) {
      if (multipliers_.size() == arrays) multipliers_.emplace_back();
      begin(lambda, multipliers_[arrays++]);
    });
}

void Chebyshev::accelerate(std::span<Projector* const> projectors, const ParticleView& particles) {
  if (iteration_ == delay) omega_ = 2 / (2 - rho_squared_);
  if (iteration_ > delay) omega_ = 4 / (4 - rho_squared_ * omega_);
  ++iteration_;
  accelerate(particles.moving, moving_);
  std::size_t arrays = 0;
  for (Projector* projector : projectors)
    projector->facets().study->multipliers(
        [&](std::span<float> lambda) { accelerate(lambda, multipliers_[arrays++]); });
}

void Chebyshev::extrapolate(Vec4f& x, const Vec4f& last, const Vec4f& before) const {
  extrapolate(x.x, last.x, before.x);
  extrapolate(x.y, last.y, before.y);
  extrapolate(x.z, last.z, before.z);
}

template <class T>
void Chebyshev::begin(std::span<T> x, History<T>& history) {
  history.last.assign(x.begin(), x.end());
  history.before.assign(x.begin(), x.end());
}

template <class T>
void Chebyshev::accelerate(std::span<T> x, History<T>& history) const {
  if (omega_ > 1)
    for (std::size_t i = 0; i < x.size(); ++i) extrapolate(x[i], history.last[i], history.before[i]);
  history.before.swap(history.last);
  history.last.assign(x.begin(), x.end());
}

void AcceleratedSolver::prepare(std::span<Projector* const> projectors, const ParticleView&) {
  linear_.clear();
  others_.clear();
  for (Projector* projector : projectors) {
    const Facets facets = projector->facets();
    (facets.linear != nullptr && facets.study != nullptr ? linear_ : others_).push_back(projector);
  }
}

void AcceleratedSolver::solve(std::span<Projector* const> projectors, const ParticleView& particles,
                              const Substep& substep, Threads& threads) {
  const bool accelerated =
      chebyshev_.helps(substep.iterations) &&
      std::all_of(others_.begin(), others_.end(), [](const Projector* p) { return p->size() == 0; });
  if (accelerated) chebyshev_.begin(linear_, particles);
  for (int iteration = 0; iteration < substep.iterations; ++iteration) {
    iterate(projectors, particles, substep, threads);
    if (accelerated) chebyshev_.accelerate(linear_, particles);
  }
}

}  // namespace souple
