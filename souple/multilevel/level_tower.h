#pragma once

#include "souple/multilevel/hierarchical_levels.h"
#include "souple/multilevel/level_links.h"
#include "souple/multilevel/pieces.h"
#include "souple/multilevel/tied_particles.h"
#include "souple/multilevel/weighted_sums.h"
#include "souple/solver/projector.h"

#include <cstdint>
#include <span>
#include <vector>

namespace souple {

/// Particles of some pieces of cloth, and the links between them.
struct FinestLevel {
  std::vector<std::uint32_t>
      particle;             ///< of the world, ascending: each stands for those that are tied to it
  std::vector<float> mass;  ///< [kg]; 0: fixed
  std::vector<Link> links;  ///< between these particles; a < b, sorted
};

/// The levels that Hierarchical describes, above pieces that all have the same number of them. They hold the state of their
/// particles and links during a substep. Pieces do not see each other.
class LevelTower {
 public:
  /// `levels`: finest first, at least one.
  LevelTower(FinestLevel finest, std::vector<CoarseLevel> levels, const TiedParticles& tied,
             const ParticleView& particles);

  std::span<const std::uint32_t> particles() const { return finest_.particle; }
  /// Other stiffnesses of the same links, in their order.
  void set_links(std::vector<Link> links);
  /// Other masses, of the same classes.
  void set_masses(std::vector<float> mass, const TiedParticles& tied, const ParticleView& particles);
  /// Corrects all levels, before the sweep of `iteration`.
  void correct(const ActivePieces& active, const ParticleView& particles, const Substep& substep,
               int iteration, Threads& threads);
  /// Links projected on coarse levels by one iteration, in all sweeps.
  std::size_t coarse_projections() const;

 private:
  /// A coarser level and the state of its particles and links during a substep. Arrays per coarse particle have
  /// one more record, for the padding of LevelLinks.
  struct Level {
    CoarseLevel map;
    WeightedSums restriction;             ///< of finer particles; first level: of the world's
    WeightedSums prolongation;            ///< a row per finer particle
    std::vector<std::uint32_t> finer;     ///< per row of the prolongation: its particle, as in `restriction`
    std::vector<std::uint32_t> particle;  ///< per coarse particle: its particle in the world
    std::vector<Vec4f> position;          ///< X at the start of the substep [m]; w = inverse mass
    std::vector<Vec4f> moving;      ///< displacement since the start of the substep [m]; w = inverse mass
    std::vector<Vec4f> before;      ///< `moving` before this iteration's corrections [m]
    std::vector<Vec4f> correction;  ///< moving - before, after the sweeps [m]
    std::vector<float> softening;   ///< per link: factor of its compliance, see set_gains
    LevelLinks all, near;           ///< near: copies of those around isolated pinned particles
    std::vector<std::uint32_t> near_slot;  ///< per slot of `near`: the slot in `all`
    // Per slot of `all`:
    std::vector<std::uint32_t> start_a, start_b;  ///< 4 times the particle in the world
    std::vector<float> rest_length, path_length;  ///< of the link, of its path along finer links [m]
    std::vector<float> stretch;                   ///< of the path; first level: of the link [m]
    std::vector<std::uint32_t> path_begin, path;  ///< slots of the finer links; see CoarseLevel::path
  };

  void add_level(CoarseLevel map, const TiedParticles& tied, const ParticleView& particles);
  static void add_links_near_pins(Level& level);
  /// Finds the prolongation of the first level or a coarser one.
  void find_prolongation(Level& level, bool first, const TiedParticles& tied,
                         const ParticleView& particles) const;
  void find_restriction(Level& level, bool first, const TiedParticles& tied,
                        const ParticleView& particles) const;
  /// Calls f(finer particle, part of the mass) for what the particle i below a level stands for.
  template <class Function>
  void for_each_tied(std::uint32_t i, bool first, const TiedParticles& tied, const ParticleView& particles,
                     const Function& f) const {
    first ? tied.for_each(finest_.particle[i], particles, f) : f(i, 1.0f);
  }
  void find_slots(Level& level) const;
  void measure(const ParticleView& particles, Threads& threads);
  void measure_paths(std::size_t l, Threads& threads);
  void set_gains(const Substep& substep);
  void set_gains_of(const Level& level, LevelLinks& links, int n) const;
  float softening_of(std::size_t l, std::size_t e) const;
  void restrict_particles(const ParticleView& particles, Threads& threads);
  void project_levels(const ActivePieces& active, const ParticleView& particles, Threads& threads);
  static void prolong(const Level& from, std::span<const Vec4f> inverse_mass, std::span<Vec4f> to,
                      Threads& threads);
  int sweeps_of(std::size_t l) const;

  FinestLevel finest_;
  std::vector<Level> levels_;  ///< finest first
  bool compliant_ = false;
  Substep gains_for_;  ///< substep of the current gains; length 0: none
};

}  // namespace souple
