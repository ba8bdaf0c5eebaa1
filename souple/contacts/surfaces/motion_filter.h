#pragma once

#include "souple/contacts/surfaces/surface_narrow_phase.h"
#include "souple/math/disjoint_sets.h"

#include <cstdint>
#include <span>
#include <vector>

namespace souple {

/// Prevents intersections after the solver: tests all motions again. Pairs that would still pass through each other
/// receive correction contacts, which conserve momentum. If these do not suffice (an object is squeezed between walls),
/// motions are clamped, and at last stopped. Driven particles are stopped as well and lag behind. So objects without
/// intersections never start to intersect. Surfaces that correction contacts connect are a group; groups do not see each
/// other.
class MotionFilter {
 public:
  void set_count();
  struct Result {
    std::size_t clamped = 0;    ///< number of clamps
    std::size_t first_new = 0;  ///< the first pair that is new since, see ElementPairs::update
    ShortenedMotion held;       ///< the fastest driven particle that was stopped
  };
  /// Changes the motions of particles.
  Result apply(ElementPairs& candidates, SurfaceNarrowPhase& narrow_phase, const ParticleView& particles,
               const Substep& substep, Threads& threads);
  /// Motions by the last `apply` out of the way of rigid bodies, which do not move in it. In order of object and particle,
  /// each pair once.
  std::span<const BodyPush> body_pushes() const { return pushes_; }
  /// Objects that stopped particles between them, see ContactProjector.
  std::span<const Pinch> pinches() const { return pinches_; }
  void clear_pushes() { pushes_.clear(), pinches_.clear(); }
  std::size_t bytes() const;

 private:
  void find_violations(ElementPairs& candidates, SurfaceNarrowPhase& narrow_phase,
                       const ParticleView& particles, Threads& threads);
  std::size_t refind_violations(ElementPairs& candidates, SurfaceNarrowPhase& narrow_phase,
                                const ParticleView& particles, const Substep& substep, Threads& threads);
  void append_corrections(ElementPairs& candidates, const SurfaceNarrowPhase& narrow_phase,
                          const ParticleView& particles);
  void find_groups(const ElementPairs& candidates, const ParticleView& particles);
  std::uint32_t group_of(const ElementPairs& candidates, std::span<const std::uint32_t, 4> pair,
                         const ParticleView& particles);
  void divide_violations(const ElementPairs& candidates, const ParticleView& particles, int pass);
  void solve_corrections(ElementPairs& candidates, const ParticleView& particles);
  void clamp_to_toi(const ElementPairs& candidates, const ParticleView& particles);
  bool stop(const ElementPairs& candidates, const ParticleView& particles) const;
  void stop_crowded_groups(const ElementPairs& candidates, const ParticleView& particles);
  void advance_groups_with_bodies(const ElementPairs& candidates, const ParticleView& particles);
  bool hold_driven(const ElementPairs& candidates, const ParticleView& particles);
  void begin_pushes(const ElementPairs& candidates, const ParticleView& particles);
  void end_pushes(const ParticleView& particles);
  void add_corrections(const ElementPairs& candidates, const ParticleView& particles);
  void merge_pushes();
  void find_pinches(const ElementPairs& candidates);

  std::vector<PairToi> violations_;
  // Those of a pass, by what is done about them.
  std::vector<PairToi> corrected_, clamped_, stopped_pairs_;
  DisjointSets groups_;             // surfaces that violations and corrections connect
  std::vector<int> ahead_;          // per surface: passes that its group has left out
  std::vector<int> room_;           // per group: corrections until it is stopped
  std::vector<std::uint8_t> acts_;  // per group, at its root: it has violations to correct; to advance
  std::vector<std::uint32_t> correction_pair_;
  std::vector<float> correction_toi_;
  SurfaceContactRows corrections_;                  // correction contacts, of correction_pair_
  std::vector<std::uint32_t> corrected_particles_;  // moved by the last pass
  std::vector<std::uint32_t> held_particles_;       // driven particles that the last pass stopped
  ShortenedMotion held_;                            // see Result; its speed is a distance [m]
  std::vector<Pinch> pinches_;
  std::vector<BodyPush> grips_;    // of particles by what does not give way in a pass; `moved`: none
  std::vector<BodyPush> pushes_;   // see body_pushes
  std::vector<BodyPush> stopped_;  // particles that a pass may stop in the way of bodies; `moved`: before it
  std::vector<float> clamp_toi_;   // per particle: part of the motion that remains
};

}  // namespace souple
