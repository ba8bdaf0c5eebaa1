#include "souple/multilevel/automatic.h"

#include "souple/multilevel/tet_levels.h"
#include "souple/solver/facets.h"

#include <algorithm>

namespace souple {
namespace {

SetProjector<NeoHookean>* find_tets(std::span<Projector* const> projectors) {
  for (Projector* projector : projectors)
    if (SetProjector<NeoHookean>* const tets = projector->facets().tets) return tets;
  return nullptr;
}

}  // namespace

Automatic::Automatic() : tet_levels_(std::make_unique<TetLevels>()) {}
Automatic::~Automatic() = default;

void Automatic::prepare(std::span<Projector* const> projectors, const ParticleView& particles) {
  prepare(projectors, particles, *make_threads(Threading::serial, 1));
}

// Trees are eliminated after the sweeps of all constraints, so that the ties of heavy objects hold, and before contacts.
void Automatic::prepare(std::span<Projector* const> projectors, const ParticleView& particles,
                        Threads& threads) {
  tet_levels_->prepare(find_tets(projectors), particles);
  stiff_bending_.prepare(projectors, particles);
  trees_.find(projectors, particles.position.size());
  with_trees_.assign(projectors.begin(), projectors.end());
  const auto first_contact = std::find_if(with_trees_.begin(), with_trees_.end(), [](Projector* projector) {
    return projector->facets().contact != nullptr;
  });
  with_trees_.insert(first_contact, &trees_);
  LeftOut trees;
  trees_.leave_out(trees);
  cloth_levels_.prepare(projectors, trees, particles, threads);
  left_out_changed_ = true;
}

void Automatic::find_left_out() {
  left_out_.clear();
  stiff_bending_.leave_out(left_out_);
  trees_.leave_out(left_out_);
  left_out_changed_ = false;
}

int Automatic::sweep_count(Projector& projector, const Substep& substep) const {
  return substep.iterations * (substep.stores_multipliers() ? 1 : sweeps_needed(projector, substep));
}

LeftOut Automatic::solved_exactly(const Substep& substep) const {
  LeftOut exact;
  if (substep.mode != Mode::small_steps) return exact;
  stiff_bending_.leave_out(exact);
  trees_.leave_out(exact);
  return exact;
}

void Automatic::solve(std::span<Projector* const> projectors, const ParticleView& particles,
                      const Substep& substep, Threads& threads) {
  tet_levels_->choose(substep);
  if (substep.mode != Mode::small_steps) {
    Substep swept = substep;
    for (int iteration = 0; iteration < substep.iterations; ++iteration) {
      swept.sweep = substep.first_sweep() + iteration;
      sweep_as_needed(projectors, particles, swept, threads, sweeps_);
    }
    return;
  }
  if (stiff_bending_.begin_substep(substep) || left_out_changed_) find_left_out();
  Substep swept = substep;
  swept.left_out = &left_out_;
  if (trees_.has_trees()) trees_.begin_substep(particles, substep);
  const bool with_levels = cloth_levels_.begin_substep(projectors, particles, substep);
  for (int iteration = 0; iteration < substep.iterations; ++iteration) {
    stiff_bending_.solve(particles, iteration, threads);
    if (with_levels) cloth_levels_.correct(particles, substep, iteration, threads);
    tet_levels_->correct(projectors, particles, substep, threads);
    swept.sweep = substep.first_sweep() + iteration;
    sweep_as_needed(trees_.has_trees() ? with_trees_ : projectors, particles, swept, threads, sweeps_);
    if (with_levels) cloth_levels_.shorten_stretched(projectors, particles, substep, threads);
  }
  if (trees_.has_trees() && substep.external != nullptr)
    trees_.add_external(*substep.external, particles, substep);
}

}  // namespace souple
