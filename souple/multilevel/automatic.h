#pragma once

#include "souple/multilevel/hierarchical.h"
#include "souple/multilevel/stiff_bending.h"
#include "souple/multilevel/tree_elimination.h"
#include "souple/solver/left_out.h"
#include "souple/solver/solver.h"

#include <memory>
#include <vector>

namespace souple {

class TetLevels;

/// SolverKind::automatic, the default: what is set is what results, at any resolution. Each kind of object gets what
/// it needs; docs/solvers.md, "Automatic", has the rule and its figures. In this order, per iteration:
///
///   StiffBending       bending of stiff sheets and ropes, solved at once
///   Hierarchical       levels of cloth pieces that sweeps leave too soft
///   TetLevels          a coarse lattice for stiff, fine tets
///   sweep_as_needed    Gauss-Seidel of all that remains, as often as the material needs, contacts last
///   TreeElimination    ropes and other trees of distances, before the contacts of each round
///
/// Small objects get plain Gauss-Seidel. Modes xpbd and pbd sweep everything.
class Automatic final : public Solver {
 public:
  Automatic();
  ~Automatic() override;
  std::string_view name() const override { return "automatic"; }
  using Solver::prepare;
  void prepare(std::span<Projector* const> projectors, const ParticleView& particles,
               Threads& threads) override;
  void prepare(std::span<Projector* const> projectors, const ParticleView& particles) override;
  void solve(std::span<Projector* const> projectors, const ParticleView& particles, const Substep& substep,
             Threads& threads) override;
  int sweep_count(Projector& projector, const Substep& substep) const override;
  LeftOut solved_exactly(const Substep& substep) const override;

 private:
  void find_left_out();

  StiffBending stiff_bending_;
  Hierarchical cloth_levels_{Hierarchical::Pieces::large};
  std::unique_ptr<TetLevels> tet_levels_;
  TreeElimination trees_;
  LeftOut left_out_;  ///< of sweeps: constraints of stiff_bending_ and trees_
  bool left_out_changed_ = true;
  std::vector<Projector*> with_trees_;  ///< all projectors and trees_, in order of solution
  SweepScratch sweeps_;
};

}  // namespace souple
