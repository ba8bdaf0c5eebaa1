#include "souple/solver/gauss_seidel.h"

#include "souple/solver/external_moves.h"
#include "souple/solver/linear_system.h"

#include <algorithm>
#include <cmath>

namespace souple {
namespace {

void project_color(Projector& projector, int color, const ParticleView& particles, const Substep& substep,
                   Threads& threads) {
  threads.for_each(projector.color_size(color), projector.grain(), [&](std::size_t begin, std::size_t end) {
    projector.project(color, begin, end, particles, substep);
  });
}

}  // namespace

void sweep(Projector& projector, const ParticleView& particles, const Substep& substep, Threads& threads) {
  ExternalMoves* const external =
      substep.external != nullptr && substep.external->concerns(projector) ? substep.external : nullptr;
  if (external != nullptr) external->before(particles);
  for (int color = 0; color < projector.color_count(); ++color)
    project_color(projector, color, particles, substep, threads);
  if (external != nullptr) external->after(particles);
}

bool in_contact(std::span<Projector* const> projectors) {
  return std::any_of(projectors.begin(), projectors.end(),
                     [](const Projector* p) { return p->is_contact() && p->size() > 0; });
}

void sweep_as_needed(std::span<Projector* const> projectors, const ParticleView& particles,
                     const Substep& substep, Threads& threads) {
  const bool touches = in_contact(projectors);
  const auto needed = [&](const Projector& p) {
    return substep.stores_multipliers() ? 1 : p.sweeps_needed(substep, touches);
  };
  int rounds = 1;
  for (const Projector* projector : projectors) rounds = std::max(rounds, needed(*projector));
  for (int round = 0; round < rounds; ++round)
    for (Projector* projector : projectors) {
      const int sweeps = needed(*projector);
      if (round >= sweeps && !projector->is_contact()) continue;
      Substep part = substep;
      part.h /= std::sqrt(static_cast<float>(sweeps));
      sweep(*projector, particles, part, threads);
    }
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
  const bool accelerated =
      chebyshev_.helps(substep.iterations) &&
      std::all_of(others_.begin(), others_.end(), [](const Projector* p) { return p->size() == 0; });
  if (accelerated) chebyshev_.begin(linear_, particles);
  for (int iteration = 0; iteration < substep.iterations; ++iteration) {
    if (settings_.sweep == Sweep::symmetric) {
      sweep_symmetric(particles, substep, threads);
    } else {
      for (Projector* projector : projectors) sweep(*projector, particles, substep, threads);
    }
    if (accelerated) chebyshev_.accelerate(linear_, particles);
  }
}

void GaussSeidel::sweep_symmetric(const ParticleView& particles, const Substep& substep, Threads& threads) {
  for (Projector* projector : linear_) sweep(*projector, particles, substep, threads);
  for (auto projector = linear_.rbegin(); projector != linear_.rend(); ++projector)
    for (int color = (*projector)->color_count(); color-- > 0;)
      project_color(**projector, color, particles, substep, threads);
  for (Projector* projector : others_) sweep(*projector, particles, substep, threads);
}

}  // namespace souple
