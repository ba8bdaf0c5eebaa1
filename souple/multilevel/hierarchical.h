#pragma once

#include "souple/multilevel/level_cache.h"
#include "souple/multilevel/level_tower.h"
#include "souple/multilevel/stretched_links.h"
#include "souple/multilevel/tied_particles.h"
#include "souple/solver/left_out.h"
#include "souple/solver/solver.h"

#include <string>
#include <vector>

namespace souple {

/// Hierarchical position-based dynamics after Müller 2008 ("Hierarchical Position Based Dynamics", VRIPHYS).
/// Before each iteration of Gauss-Seidel, levels of ever fewer particles correct errors of long wavelength.
/// Gauss-Seidel corrects such errors slowly, for example the stretch of a large cloth as a whole. Coarsest level first:
///
///   restrict     X_J = sum_i w_iJ m_i x_i / m_J,   m_J = sum_i w_iJ m_i       (positions and displacements)
///   project      l_JK <= |X_J - X_K| <= L_JK for the links of each level, a few sweeps
///   prolong      d_i += sum_J w_iJ (correction of J)
///
/// A coarse particle is the weighted mean of the finer particles that follow it; in the paper it is a finer
/// particle. With the mean, corrections of a level add no kinetic energy (as far as C is linear), whatever links the
/// level has. Momentum is conserved. With injection a swinging 100 x 100 cloth exploded within ten frames
/// (docs/notes/solvers.md).
///
/// The limits l_JK and L_JK: LinkLimits (kernels/links.h). A link whose finer links are all satisfied does not
/// shrink, however inexact its rest length is. Lower limits let cloth fold freely (the paper's unilateral
/// constraints alone crumple a moving cloth, two cells at a time).
///
/// Where a few pinned particles carry a whole cloth, stress grows towards them faster than levels get finer.
/// There each level sweeps the links around them a few times more.
///
/// Particles that are tied rigidly are one particle of the levels, and attached ones are fixed (TiedParticles). While a
/// tie is open by more than a link, its piece has no levels: they would close it at once, however large the cloth.
///
/// With compliance, a coarse link is a spring in parallel with the finer links. Its stiffness and the
/// stiffness that the sweeps of the finer levels reach add up to that of the material.
///
/// Stress may change from link to link, as where cloth touches a collider. Stretched links of the finest level are then
/// swept more often, together with their contacts (StretchedLinks).
///
/// Needs kinds that state their links (constraints/constraint.h); others get Gauss-Seidel alone. Linear
/// momentum is kept to rounding, angular momentum as far as the cloth is smooth.
class Hierarchical final : public Solver {
 public:
  /// Pieces of cloth that get levels: all, or large ones and long strips, which sweeps leave too soft.
  enum class Pieces { all, large };
  explicit Hierarchical(Pieces pieces = Pieces::all) : pieces_(pieces) {}

  std::string_view name() const override { return "hierarchical"; }
  void prepare(std::span<Projector* const> projectors, const ParticleView& particles,
               Threads& threads) override {
    prepare(projectors, {}, particles, threads);
  }
  void prepare(std::span<Projector* const> projectors, const ParticleView& particles) override;
  void solve(std::span<Projector* const> projectors, const ParticleView& particles, const Substep& substep,
             Threads& threads) override;

  // For a solver that uses the levels among other parts:
  /// Builds the levels, unless their inputs are unchanged: links without `left_out`, rest lengths, ties, masses.
  void prepare(std::span<Projector* const> projectors, const LeftOut& left_out, const ParticleView& particles,
               Threads& threads);
  /// Whether levels act on any piece in this substep. Moves attached particles to their targets.
  bool begin_substep(std::span<Projector* const> projectors, const ParticleView& particles,
                     const Substep& substep);
  /// Corrects all levels, before the sweep of `iteration`.
  void correct(const ParticleView& particles, const Substep& substep, int iteration, Threads& threads);
  /// Sweeps links that are stretched after the sweep of all constraints.
  void shorten_stretched(std::span<Projector* const> projectors, const ParticleView& particles,
                         const Substep& substep, Threads& threads);
  std::string diagnostic() const override;

  /// Links projected on coarse levels by one iteration, in all sweeps.
  std::size_t coarse_projections() const;

 private:
  /// The levels of pieces that have equally many.
  struct Tower {
    LevelTower levels;
    std::vector<IndexRange> particles, links;  ///< their places in particle_ and links_
  };

  /// `links`: ends are linked particles.
  void build(std::span<const Link> links, const ParticleView& particles, Threads& threads);
  std::vector<Link> links_of(const Tower& tower) const;
  std::vector<float> masses_of(const Tower& tower) const;
  void find_pieces(std::size_t particles);
  void start_pieces(const ParticleView& particles, const Substep& substep);
  void sweep_attached(Projector& projector, const ParticleView& particles, const Substep& substep) const;
  bool constraints_changed(std::span<Projector* const> projectors);
  bool masses_changed(const ParticleView& particles) const;
  /// Whether the mass of any particle changed since the last call.
  bool any_mass_changed(const ParticleView& particles);
  std::vector<Link> links_of(std::span<Projector* const> projectors, const LeftOut& left_out,
                             const ParticleView& particles) const;

  Pieces pieces_;
  std::vector<std::pair<const Projector*, std::uint64_t>> revisions_;  ///< of the sets that links_ come from
  std::vector<Link> links_;              ///< links of the finest level; ends are the world's particles
  TiedParticles tied_;                   ///< one linked particle each
  std::vector<float> seen_;              ///< inverse masses of all particles [1/kg]
  std::vector<float> masses_;            ///< per linked particle [kg]; 0: fixed
  std::vector<char> classes_;            ///< per linked particle: see classes_of
  std::vector<std::uint32_t> particle_;  ///< per linked particle: its representative in the world, ascending
  LevelCache cache_;
  std::vector<Tower> towers_;
  StretchedLinks stretched_;  ///< of the finest level; built when a link is stretched
  ActivePieces active_;
  std::vector<float> mean_length_;  ///< per piece: of its links of the finest level [m]
};

}  // namespace souple
