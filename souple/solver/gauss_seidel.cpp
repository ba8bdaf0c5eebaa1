#include "souple/solver/gauss_seidel.h"

#include "souple/assert.h"
#include "souple/solver/external_moves.h"
#include "souple/solver/facets.h"
#include "souple/solver/sweep_regions.h"

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

/// Takes back the motion of a range of particles.
void take_back_motion(const IndexRange& range, const ParticleView& particles, Threads& threads,
                      std::vector<Vec4f>& motion) {
  threads.each(range.end - range.begin, motion_grain, [&](std::size_t k) {
    const std::size_t i = range.begin + k;
    motion[i].set_xyz(particles.moved(i));
    particles.moving[i].set_xyz(particles.start[i].xyz());
  });
}

void add_motion(const IndexRange& range, std::span<const Vec4f> motion, float part,
                const ParticleView& particles, Threads& threads) {
  threads.each(range.end - range.begin, motion_grain, [&](std::size_t k) {
    const std::size_t i = range.begin + k;
    particles.moving[i].set_xyz(particles.moving[i].xyz() + motion[i].xyz() * part);
  });
}

/// Every second sweep of the contacts of grains is in reverse order.
bool is_reversed(Projector& projector, const Substep& substep) {
  return projector.facets().alternates && substep.sweep % 2 == 1;
}

/// Calls `sweep_all` between the notes of what it moves.
template <class SweepAll>
void record(Projector& projector, const ParticleView& particles, const Substep& substep,
            const SweepAll& sweep_all) {
  ExternalMoves* const external =
      substep.external != nullptr && substep.external->concerns(projector) ? substep.external : nullptr;
  if (external != nullptr) external->before(particles);
  sweep_all();
  if (external != nullptr) external->after(particles);
}

}  // namespace

void sweep_color(Projector& projector, int color, const ParticleView& particles, const Substep& substep,
                 Threads& threads) {
  threads.for_each(
      projector.color_size(color), projector.facets().grain,
      [&](std::size_t begin, std::size_t end) { projector.project(color, begin, end, particles, substep); });
}

void sweep(Projector& projector, const ParticleView& particles, const Substep& substep, Threads& threads) {
  const int count = projector.color_count();
  const bool reversed = is_reversed(projector, substep);
  record(projector, particles, substep, [&] {
    for (int k = 0; k < count; ++k)
      sweep_color(projector, reversed ? count - 1 - k : k, particles, substep, threads);
  });
}

void sweep(Projector& projector, std::span<const SweptRun> runs, const ParticleView& particles,
           const Substep& substep, Threads& threads) {
  const bool reversed = is_reversed(projector, substep);
  const std::size_t grain = projector.facets().grain;
  record(projector, particles, substep, [&] {
    for (std::size_t k = 0; k < runs.size(); ++k) {
      const SweptRun& run = runs[reversed ? runs.size() - 1 - k : k];
      threads.for_each(run.end - run.begin, grain, [&](std::size_t begin, std::size_t end) {
        projector.project(run.color, run.begin + begin, run.begin + end, particles, substep);
      });
    }
  });
}

namespace {

/// Sweeps of one class of regions; null: of all constraints.
struct Rounds {
  std::span<Projector* const> projectors;
  const ParticleView& particles;
  const Substep& substep;
  Threads& threads;

  void find_sweeps(std::vector<int>& sweeps) const {
    sweeps.clear();
    for (Projector* const projector : projectors)
      sweeps.push_back(substep.stores_multipliers() ? 1 : sweeps_needed(*projector, substep));
  }
  void sweep_round(int round, int rounds, const SweepClass* of, std::span<const int> sweeps) const {
    const bool in_parts = rounds > max_rounds_of_whole_motion;
    for (std::size_t p = 0; p < projectors.size(); ++p) {
      const int first = in_parts ? rounds - sweeps[p] : 0;
      if ((round < first || round >= first + sweeps[p]) && !projectors[p]->facets().every_round) continue;
      Substep part = substep;
      part.h /= std::sqrt(static_cast<float>(sweeps[p]));
      part.sweep = substep.sweep * rounds + round;
      if (of != nullptr)
        sweep(*projectors[p], of->runs[p], particles, part, threads);
      else
        sweep(*projectors[p], particles, part, threads);
    }
  }
  void run(const SweepClass* of, std::span<const int> sweeps, std::vector<Vec4f>& motion) const {
    const IndexRange all{0, particles.moving.size()};
    const std::span<const IndexRange> ranges =
        of != nullptr ? std::span<const IndexRange>(of->particles) : std::span(&all, 1);
    const int rounds = std::max(1, *std::max_element(sweeps.begin(), sweeps.end()));
    const bool in_parts = rounds > max_rounds_of_whole_motion;
    if (in_parts) motion.resize(particles.moving.size());
    for (const IndexRange& range : ranges)
      if (in_parts) take_back_motion(range, particles, threads, motion);
    for (int round = 0; round < rounds; ++round) {
      for (const IndexRange& range : ranges)
        if (in_parts) add_motion(range, motion, part_of_motion(round, rounds), particles, threads);
      sweep_round(round, rounds, of, sweeps);
    }
  }
};

}  // namespace

void sweep_as_needed(std::span<Projector* const> projectors, const ParticleView& particles,
                     const Substep& substep, Threads& threads, SweepScratch& scratch) {
  if (projectors.empty()) return;
  const Rounds rounds{projectors, particles, substep, threads};
  std::span<const SweepClass> classes;
  if (substep.regions != nullptr && !substep.stores_multipliers())
    classes = substep.regions->classes(projectors, particles, substep);
  for (const SweepClass& of : classes) rounds.run(&of, of.sweeps, scratch.motion);
  if (!classes.empty()) return;
  rounds.find_sweeps(scratch.sweeps);
  rounds.run(nullptr, scratch.sweeps, scratch.motion);
}

void GaussSeidel::solve(std::span<Projector* const> projectors, const ParticleView& particles,
                        const Substep& substep, Threads& threads) {
  Substep swept = substep;
  for (int iteration = 0; iteration < substep.iterations; ++iteration) {
    swept.sweep = substep.first_sweep() + iteration;
    for (Projector* projector : projectors) sweep(*projector, particles, swept, threads);
  }
}

}  // namespace souple
