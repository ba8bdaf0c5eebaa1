#pragma once

#include "souple/solver/left_out.h"
#include "souple/solver/projector.h"
#include "souple/solver/solver_settings.h"
#include "souple/threads/threads.h"

#include <span>
#include <string>
#include <string_view>

namespace souple {

/// Moves the particles of a world towards satisfying all constraints, once per substep.
class Solver {
 public:
  virtual ~Solver() = default;

  /// The name that users write.
  virtual std::string_view name() const = 0;
  /// Call after constraints or particles changed and before the next `solve`; projectors are prepared
  /// already. Throws Error when the solver cannot handle the scene (too large, too many coupled rows); the
  /// message names an alternative.
  virtual void prepare(std::span<Projector* const> projectors, const ParticleView& particles) = 0;
  /// Prepares on several threads, for solvers that take long. The default uses the caller's alone.
  virtual void prepare(std::span<Projector* const> projectors, const ParticleView& particles, Threads&) {
    prepare(projectors, particles);
  }
  /// Runs all iterations of a substep. `projectors` are in solving order, contacts last; begin_substep of
  /// each has been called.
  virtual void solve(std::span<Projector* const> projectors, const ParticleView& particles,
                     const Substep& substep, Threads& threads) = 0;
  /// Number of sweeps of a substep that supply the stiffness of a projector's constraints; 0: they are solved exactly.
  virtual int sweep_count(Projector&, const Substep& substep) const { return substep.iterations; }
  /// Constraints that are solved exactly although sweeps supply others of their projector.
  virtual LeftOut solved_exactly(const Substep&) const { return {}; }
  /// Information for users about the solution (a floor on alpha, iterations of conjugate gradients), or
  /// empty.
  virtual std::string diagnostic() const { return {}; }
};

/// Projects all constraints of a color once, on all threads.
void sweep_color(Projector& projector, int color, const ParticleView& particles, const Substep& substep,
                 Threads& threads);

/// Projects all constraints of a projector once, color after color.
void sweep(Projector& projector, const ParticleView& particles, const Substep& substep, Threads& threads);
/// Projects those of some runs, ascending.
void sweep(Projector& projector, std::span<const SweptRun> runs, const ParticleView& particles,
           const Substep& substep, Threads& threads);

/// Work space of sweep_as_needed.
struct SweepScratch {
  std::vector<Vec4f> motion;
  std::vector<int> sweeps;  ///< per projector
};

/// Sweeps each projector as often as it needs to be as stiff as its material (ElasticFacet::sweeps_needed), in
/// rounds; each class of regions (SweepRegions) for itself. Contacts take part in every round: a stiff body that is swept alone pushes itself back into them and
/// trembles. With stored multipliers there is one round. With more than 10 rounds, each advances the particles by a
/// part of their motion in the substep. Projectors with fewer sweeps take part in the last rounds.
void sweep_as_needed(std::span<Projector* const> projectors, const ParticleView& particles,
                     const Substep& substep, Threads& threads, SweepScratch& scratch);

}  // namespace souple
