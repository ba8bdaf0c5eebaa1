#include "souple/solver/gauss_seidel.h"

#include "souple/assert.h"
#include "souple/solver/external_moves.h"
#include "souple/solver/facets.h"

#include <algorithm>
#include <cmath>

namespace souple {
namespace {

// n sweeps act as the mean of C over them. If a body at rest first falls by g h^2 and the sweeps then lift it, that
// mean is g h^2 / 2 below the result. A bar then hangs that much too high. Where g h^2 matters, the motion of the
// substep is divided among the rounds: half a part, n - 1 parts, half a part. The mean is then the result.
constexpr int max_rounds_of_whole_motion = 10;
constexpr std::size_t motion_grain = 4096;

float part_of_motion(int round, int rounds) {
  SOUPLE_ASSERT(0 <= round && round < rounds, "one of the rounds");
  const float part = 1 / static_cast<float>(rounds);
  return (round == 0 ? part / 2 : part) + (round == rounds - 1 ? part / 2 : 0);
}

void take_back_motion(const ParticleView& particles, Threads& threads, std::vector<Vec4f>& motion) {
  motion.resize(particles.moving.size());
  threads.each(motion.size(), motion_grain, [&](std::size_t i) {
    motion[i].set_xyz(particles.moved(i));
    particles.moving[i].set_xyz(particles.start[i].xyz());
  });
}

void add_motion(std::span<const Vec4f> motion, float part, const ParticleView& particles, Threads& threads) {
  threads.each(motion.size(), motion_grain, [&](std::size_t i) {
    particles.moving[i].set_xyz(particles.moving[i].xyz() + motion[i].xyz() * part);
  });
}

}  // namespace

void sweep_color(Projector& projector, int color, const ParticleView& particles, const Substep& substep,
                 Threads& threads) {
  threads.for_each(
      projector.color_size(color), projector.facets().grain,
      [&](std::size_t begin, std::size_t end) { projector.project(color, begin, end, particles, substep); });
}

void sweep(Projector& projector, const ParticleView& particles, const Substep& substep, Threads& threads) {
  ExternalMoves* const external =
      substep.external != nullptr && substep.external->concerns(projector) ? substep.external : nullptr;
  if (external != nullptr) external->before(particles);
  for (int color = 0; color < projector.color_count(); ++color)
    sweep_color(projector, color, particles, substep, threads);
  if (external != nullptr) external->after(particles);
}

void sweep_as_needed(std::span<Projector* const> projectors, const ParticleView& particles,
                     const Substep& substep, Threads& threads, std::vector<Vec4f>& motion) {
  const auto needed = [&](Projector& p) {
    return substep.stores_multipliers() ? 1 : sweeps_needed(p, substep);
  };
  int rounds = 1;
  for (Projector* projector : projectors) rounds = std::max(rounds, needed(*projector));
  const bool in_parts = rounds > max_rounds_of_whole_motion;
  if (in_parts) take_back_motion(particles, threads, motion);
  for (int round = 0; round < rounds; ++round) {
    if (in_parts) add_motion(motion, part_of_motion(round, rounds), particles, threads);
    for (Projector* projector : projectors) {
      const int sweeps = needed(*projector);
      const int first = in_parts ? rounds - sweeps : 0;
      if ((round < first || round >= first + sweeps) && !projector->facets().every_round) continue;
      Substep part = substep;
      part.h /= std::sqrt(static_cast<float>(sweeps));
      sweep(*projector, particles, part, threads);
    }
  }
}

void GaussSeidel::solve(std::span<Projector* const> projectors, const ParticleView& particles,
                        const Substep& substep, Threads& threads) {
  for (int iteration = 0; iteration < substep.iterations; ++iteration)
    for (Projector* projector : projectors) sweep(*projector, particles, substep, threads);
}

}  // namespace souple
