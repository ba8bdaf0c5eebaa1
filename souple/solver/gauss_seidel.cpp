#include "souple/solver/gauss_seidel.h"

#include "souple/solver/linear_system.h"

#include <algorithm>

namespace souple {
namespace {

void project_colour(Projector& projector, int colour, const ParticleView& particles, const Substep& substep,
                    Threads& threads) {
  threads.for_each(projector.colour_size(colour), projector.grain(), [&](std::size_t begin, std::size_t end) {
    projector.project(colour, begin, end, particles, substep);
  });
}

}  // namespace

void sweep(Projector& projector, const ParticleView& particles, const Substep& substep, Threads& threads) {
  for (int colour = 0; colour < projector.colour_count(); ++colour)
    project_colour(projector, colour, particles, substep, threads);
}

void GaussSeidel::prepare(std::span<Projector* const> projectors, const ParticleView& particles) {
  linear_.clear();
  others_.clear();
  if (settings_.sweep == Sweep::forward && settings_.chebyshev == 0) return;
  for (Projector* projector : projectors)
    (has_linear_form(*projector, particles) ? linear_ : others_).push_back(projector);
}

void GaussSeidel::solve(std::span<Projector* const> projectors, const ParticleView& particles,
                        const Substep& substep, Threads& threads) {
  Substep relaxed = substep;
  relaxed.relaxation = settings_.relaxation;
  const bool accelerated =
      chebyshev_.helps(substep.iterations) &&
      std::all_of(others_.begin(), others_.end(), [](const Projector* p) { return p->size() == 0; });
  if (accelerated) chebyshev_.begin(linear_, particles);
  for (int iteration = 0; iteration < substep.iterations; ++iteration) {
    if (settings_.sweep == Sweep::symmetric) {
      sweep_symmetric(particles, relaxed, threads);
    } else {
      for (Projector* projector : projectors) sweep(*projector, particles, relaxed, threads);
    }
    if (accelerated) chebyshev_.accelerate(linear_, particles);
  }
}

void GaussSeidel::sweep_symmetric(const ParticleView& particles, const Substep& substep, Threads& threads) {
  for (Projector* projector : linear_) sweep(*projector, particles, substep, threads);
  for (auto projector = linear_.rbegin(); projector != linear_.rend(); ++projector)
    for (int colour = (*projector)->colour_count(); colour-- > 0;)
      project_colour(**projector, colour, particles, substep, threads);
  for (Projector* projector : others_) sweep(*projector, particles, substep, threads);
}

}  // namespace souple
