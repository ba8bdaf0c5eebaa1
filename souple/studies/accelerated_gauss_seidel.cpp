#include "souple/studies/accelerated_gauss_seidel.h"

namespace souple {

void AcceleratedGaussSeidel::iterate(std::span<Projector* const> projectors, const ParticleView& particles,
                                     const Substep& substep, Threads& threads) {
  const auto sweep_all = [&](std::span<Projector* const> swept) {
    for (Projector* projector : swept) sweep(*projector, particles, substep, threads);
  };
  if (sweep_ == Sweep::forward) return sweep_all(projectors);
  sweep_all(linear_);
  for (auto projector = linear_.rbegin(); projector != linear_.rend(); ++projector)
    for (int color = (*projector)->color_count(); color-- > 0;)
      sweep_color(**projector, color, particles, substep, threads);
  sweep_all(others_);
}

}  // namespace souple
