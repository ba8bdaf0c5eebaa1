#include "souple/studies/jacobi.h"

#include "souple/solver/facets.h"

namespace souple {
namespace {

constexpr std::size_t particle_grain = 1024;  // minimum number of particles per thread

}  // namespace

void Jacobi::prepare(std::span<Projector* const> projectors, const ParticleView& particles) {
  AcceleratedSolver::prepare(projectors, particles);
  const std::size_t n = particles.position.size();
  count_.assign(n, 0);
  split_.resize(n);
  correction_.resize(n);
  for (Projector* projector : linear_)
    for (const std::uint32_t particle : projector->facets().study->indices()) ++count_[particle];
}

// The projectors read `split_` and add to `correction_`, so all of them see the same positions.
void Jacobi::iterate(std::span<Projector* const>, const ParticleView& particles, const Substep& substep,
                     Threads& threads) {
  threads.for_each(split_.size(), particle_grain, [&](std::size_t begin, std::size_t end) {
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
  threads.for_each(split_.size(), particle_grain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      if (count_[i] > 0) particles.correct(i, correction_[i].xyz() / count_[i]);
  });
  for (Projector* projector : others_) sweep(*projector, particles, substep, threads);
}

}  // namespace souple
