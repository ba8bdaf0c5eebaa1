#pragma once

#include "souple/constraints/particle_contact.h"
#include "souple/constraints/tether.h"
#include "souple/solver/hierarchical_levels.h"
#include "souple/solver/set_projector.h"
#include "souple/solver/solver.h"

#include <string>
#include <vector>

namespace souple {

/// Hierarchical position-based dynamics after Müller 2008 ("Hierarchical Position Based Dynamics", VRIPHYS):
/// before each iteration of Gauss-Seidel, levels of ever fewer particles correct what Gauss-Seidel is slow
/// at, the stretch of a large cloth as a whole. Coarsest level first:
///
///   restrict     X_J = sum_i w_iJ m_i x_i / m_J,   m_J = sum_i w_iJ m_i       (positions and displacements)
///   project      l_JK <= |X_J - X_K| <= L_JK for the links of each level, a few sweeps
///   prolong      d_i += sum_J w_iJ (what J was corrected by)
///
/// A coarse particle is the mean of those that follow it, not one of them as in the paper: then what a level
/// corrects adds no kinetic energy (as far as C is linear), whatever the level is made of, and momentum is
/// kept. With injection a swinging 100 x 100 cloth exploded within ten frames (docs/solvers.md).
///
/// L_JK: a link that is stretched when the substep begins shrinks by its stretch, one that is folded may
/// unfold, and one whose finer links all hold is not shrunk, however badly its rest length is known. l_JK: no
/// correction presses together what was not stretched, but what moves together by itself may, so that cloth
/// folds freely (the paper's unilateral constraints alone crumple a moving cloth, two cells at a time).
///
///   L_JK = |X_J - X_K| max(rest length / |x_J - x_K|, 1 - stretch of the way from J to K along finer links)
///   l_JK = min(L_JK, |X_J - X_K| at the substep's beginning, the same as predicted)
///
/// With compliance, a coarse link is a spring beside the finer ones, strong enough to supply, together with
/// what the sweeps of the finer levels reach, the stiffness of the material and no more.
///
/// Needs SetProjector<Distance> or SetProjector<TriangleMembrane>; what has neither gets Gauss-Seidel alone.
/// Linear momentum is kept to rounding, angular momentum as far as the cloth is smooth.
class Hierarchical final : public Solver {
 public:
  explicit Hierarchical(const SolverSettings&) {}

  std::string_view name() const override { return "hierarchical"; }
  /// Builds the levels, unless what they depend on is as it was: links, rest lengths, masses.
  void prepare(std::span<Projector* const> projectors, const ParticleView& particles) override;
  void solve(std::span<Projector* const> projectors, const ParticleView& particles, const Substep& substep,
             Threads& threads) override;
  std::string diagnostic() const override;

  /// Constraints projected on coarse levels by one iteration, all sweeps.
  std::size_t coarse_projections() const;

 private:
  /// A coarser level and what its particles and links hold during a substep.
  struct Level {
    CoarseLevel map;
    std::vector<std::uint32_t> particle;     ///< of the world
    std::vector<std::uint32_t> constraint;   ///< of each link, in both sets; none where neither end moves
    std::vector<Vec4f> position;             ///< X at the substep's beginning; w = inverse mass
    std::vector<Vec4f> moving;               ///< displacement since
    std::vector<Vec4f> before;               ///< the same before anything was corrected
    std::vector<Vec4f> correction;           ///< moving - before, once solved
    std::vector<float> stretch;              ///< of the way along finer links of each link [m]
    std::vector<float> path_length;          ///< at rest [m]
    std::vector<float> softening;            ///< of each link, see set_compliance
    SetProjector<Tether> at_most;            ///< |X_J - X_K| <= L_JK
    SetProjector<ParticleContact> at_least;  ///< |X_J - X_K| >= l_JK; in the same order
    Column* max_length = nullptr;            ///< L of `at_most`, rewritten during steps
    Column* min_length = nullptr;            ///< l of `at_least`
    Column* compliance = nullptr;            ///< of `at_most`
  };

  void add_level(CoarseLevel map);
  void measure(const ParticleView& particles, Threads& threads);
  void measure_level(std::size_t l, std::span<const Vec4f> start, std::size_t begin, std::size_t end);
  float stretch_ratio(std::size_t l, std::size_t e, std::span<const Vec4f> start);
  void set_compliance(const Substep& substep);
  float softening_of(std::size_t l, std::size_t e) const;
  void restrict_particles(const ParticleView& particles, Threads& threads);
  void project_levels(const Substep& substep, bool first, Threads& threads);
  int sweeps_of(std::size_t l) const;

  std::vector<Link> links_;              ///< finest; ends are the world's particles
  std::vector<float> inverse_masses_;    ///< of the world's particles at its ends, summed, for each link
  std::vector<float> masses_;            ///< of the linked particles; 0: does not move
  std::vector<std::uint32_t> particle_;  ///< the linked particles, ascending
  std::vector<Level> levels_;            ///< finest first
  bool compliant_ = false;
  float h_ = 0;  ///< that compliances were last set for
  int iterations_ = 0;
};

}  // namespace souple
