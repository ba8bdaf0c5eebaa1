#include "souple/solver/chebyshev.h"

namespace souple {

void Chebyshev::begin(std::span<Projector* const> projectors, const ParticleView& particles) {
  iteration_ = 0;
  omega_ = 1;
  begin(particles.moving, moving_);
  std::size_t arrays = 0;
  for (Projector* projector : projectors)
    projector->multipliers([&](std::span<float> lambda) {
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
    projector->multipliers([&](std::span<float> lambda) { accelerate(lambda, multipliers_[arrays++]); });
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

}  // namespace souple
