#include "souple/solver/jacobi.h"

#include <algorithm>

namespace souple {
namespace {

constexpr std::size_t grain = 1024;  // minimum number of particles per thread

}  // namespace

void Jacobi::prepare(std::span<Projector* const> projectors, const ParticleView& particles) {
  linear_.clear();
  others_.clear();
  const std::size_t n = particles.position.size();
  count_.assign(n, 0);
  split_.resize(n);
  correction_.resize(n);
  const auto count = [this](const LinearConstraint& constraint) {
    for (const std::uint32_t particle : constraint.particles) ++count_[particle];
  };
  for (Projector* projector : projectors)
    (projector->linearize(particles, Substep{.h = 1}, count) ? linear_ : others_).push_back(projector);
}

void Jacobi::solve(std::span<Projector* const>, const ParticleView& particles, const Substep& substep,
                   Threads& threads) {
  const bool accelerated =
      chebyshev_.helps(substep.iterations) &&
      std::all_of(others_.begin(), others_.end(), [](const Projector* p) { return p->size() == 0; });
  if (accelerated) chebyshev_.begin(linear_, particles);
  for (int iteration = 0; iteration < substep.iterations; ++iteration) {
    iterate(particles, substep, threads);
    for (Projector* projector : others_) sweep(*projector, particles, substep, threads);
    if (accelerated) chebyshev_.accelerate(linear_, particles);
  }
}

// The projectors read `split_` and add to `correction_`, so all of them see the same positions.
void Jacobi::iterate(const ParticleView& particles, const Substep& substep, Threads& threads) {
  threads.for_each(split_.size(), grain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      split_[i] = particles.position[i];
      split_[i].w *= count_[i];
      correction_[i] = {};
    }
  });
  ParticleView view = particles;
  view.position = split_;
  view.corrected = correction_;
  for (Projector* projector : linear_) sweep(*projector, view, substep, threads);
  threads.for_each(split_.size(), grain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      if (count_[i] > 0) particles.correct(i, correction_[i].xyz() / count_[i]);
  });
}

}  // namespace souple
