#include "souple/solver/gauss_seidel.h"

namespace souple {

void sweep(Projector& projector, const ParticleView& particles, const Substep& substep, Threads& threads) {
  for (int colour = 0; colour < projector.colour_count(); ++colour)
    threads.for_each(projector.colour_size(colour), projector.grain(),
                     [&](std::size_t begin, std::size_t end) {
                       projector.project(colour, begin, end, particles, substep);
                     });
}

void GaussSeidel::solve(std::span<Projector* const> projectors, const ParticleView& particles,
                        const Substep& substep, Threads& threads) {
  for (int iteration = 0; iteration < substep.iterations; ++iteration)
    for (Projector* projector : projectors) sweep(*projector, particles, substep, threads);
}

}  // namespace souple
