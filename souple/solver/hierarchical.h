#pragma once

#include "souple/constraints/particle_contact.h"
#include "souple/constraints/tether.h"
#include "souple/solver/hierarchical_levels.h"
#include "souple/solver/set_projector.h"
#include "souple/solver/solver.h"

#include <string>
#include <vector>

namespace souple {

/// Hierarchical position-based dynamics after Müller 2008 ("Hierarchical Position Based Dynamics", VRIPHYS).
/// Before each iteration of Gauss-Seidel, levels of ever fewer particles correct errors of long wavelength,
/// such as the stretch of a large cloth as a whole, which Gauss-Seidel corrects slowly. Coarsest level first:
///
///   restrict     X_J = sum_i w_iJ m_i x_i / m_J,   m_J = sum_i w_iJ m_i       (positions and displacements)
///   project      l_JK <= |X_J - X_K| <= L_JK for the links of each level, a few sweeps
///   prolong      d_i += sum_J w_iJ (correction of J)
///
/// A coarse particle is the weighted mean of the finer particles that follow it; in the paper it is a finer
/// particle. With the mean, corrections of a level add no kinetic energy (as far as C is linear), whatever
/// links the level has, and momentum is kept. With injection a swinging 100 x 100 cloth exploded within ten
/// frames (docs/solvers.md).
///
/// L_JK: a link that is stretched at the start of the substep shrinks by its stretch, and a folded link may
/// unfold. A link whose finer links are all satisfied does not shrink, however inexact its rest length is.
/// l_JK: no correction compresses an unstretched link, but particles that approach each other on their own
/// may do so. This lets cloth fold freely (the paper's unilateral constraints alone crumple a moving cloth,
/// two cells at a time).
///
///   L_JK = |X_J - X_K| max(rest length / |x_J - x_K|, 1 - stretch of the path from J to K along finer links)
///   l_JK = min(L_JK, |X_J - X_K| at the start of the substep, |X_J - X_K| as predicted)
///
/// Where a few pinned particles carry a whole cloth, stress grows towards them faster than levels get finer.
/// There each level sweeps the links around them a few times more.
///
/// With compliance, a coarse link is a spring in parallel with the finer links. Its stiffness and the
/// stiffness that the sweeps of the finer levels reach add up to that of the material.
///
/// As SolverKind::automatic it builds levels only for pieces of cloth that need them, and sweeps each set as
/// often as its material needs (Projector::sweeps_needed).
///
/// Needs SetProjector<Distance> or SetProjector<TriangleMembrane>; other kinds get Gauss-Seidel alone. Linear
/// momentum is kept to rounding, angular momentum as far as the cloth is smooth.
class Hierarchical final : public Solver {
 public:
  explicit Hierarchical(const SolverSettings& settings)
      : automatic_(settings.kind == SolverKind::automatic) {}

  std::string_view name() const override { return automatic_ ? "automatic" : "hierarchical"; }
  /// Builds the levels, unless their inputs are unchanged: links, rest lengths, masses.
  void prepare(std::span<Projector* const> projectors, const ParticleView& particles) override;
  void solve(std::span<Projector* const> projectors, const ParticleView& particles, const Substep& substep,
             Threads& threads) override;
  std::string diagnostic() const override;

  /// Constraints projected on coarse levels by one iteration, in all sweeps.
  std::size_t coarse_projections() const;

 private:
  /// Constraints l_JK <= |X_J - X_K| <= L_JK, in equal order. Steps rewrite the columns.
  struct Bounds {
    SetProjector<Tether> at_most;
    SetProjector<ParticleContact> at_least;
    Column *max_length = nullptr, *min_length = nullptr, *compliance = nullptr;

    void add(const Link& link);
    void prepare(std::size_t particles);
    /// Sets the pointers and allocates one number per constraint; call where the object stays.
    void allocate(bool compliant);
    void project(int sweeps, const ParticleView& view, const Substep& substep, Threads& threads);
  };

  /// A coarser level and the state of its particles and links during a substep.
  struct Level {
    CoarseLevel map;
    std::vector<std::uint32_t> particle;  ///< per coarse particle: its particle in the world
    /// Per link: its constraint in `all`; none if both ends are fixed.
    std::vector<std::uint32_t> constraint;
    std::vector<Vec4f> position;    ///< X at the start of the substep [m]; w = inverse mass
    std::vector<Vec4f> moving;      ///< displacement since the start of the substep [m]
    std::vector<Vec4f> before;      ///< `moving` before this iteration's corrections [m]
    std::vector<Vec4f> correction;  ///< moving - before, after the sweeps [m]
    /// Per link: stretch of its path along finer links; first level: of the link [m].
    std::vector<float> stretch;
    std::vector<float> path_length;              ///< per link: rest length of its path [m]
    std::vector<float> softening;                ///< per link: factor of its compliance, see set_compliance
    Bounds all;                                  ///< of the links that have a constraint
    Bounds near;                                 ///< copies of those around isolated pinned particles
    std::vector<std::uint32_t> near_constraint;  ///< per copy: its constraint in `all`
  };

  void add_level(CoarseLevel map);
  static void add_links_near_pins(Level& level);
  void measure(const ParticleView& particles, Threads& threads);
  void measure_level(std::size_t l, std::span<const Vec4f> start, std::size_t begin, std::size_t end);
  float stretch_ratio(std::size_t l, std::size_t e, std::span<const Vec4f> start);
  void set_compliance(const Substep& substep);
  float softening_of(std::size_t l, std::size_t e) const;
  void restrict_particles(const ParticleView& particles, Threads& threads);
  void project_levels(const Substep& substep, Threads& threads);
  static void project_near_pins(Level& level, const ParticleView& view, const Substep& substep,
                                Threads& threads);
  int sweeps_of(std::size_t l) const;

  bool inputs_changed(std::span<Projector* const> projectors, const ParticleView& particles);

  bool automatic_;
  std::vector<std::pair<const Projector*, std::uint64_t>> revisions_;  ///< of the sets that links_ come from
  std::vector<Link> links_;              ///< links of the finest level; ends are the world's particles
  std::vector<float> inverse_masses_;    ///< per link: sum of the inverse masses of its two ends [1/kg]
  std::vector<float> masses_;            ///< per linked particle [kg]; 0: fixed
  std::vector<std::uint32_t> particle_;  ///< per linked particle: its particle in the world, ascending
  std::vector<Level> levels_;            ///< finest first
  std::vector<Vec4f> motion_;            ///< work space of sweep_as_needed
  bool compliant_ = false;
  float h_ = 0;  ///< substep length of the current compliances [s]
  int iterations_ = 0;
};

}  // namespace souple
