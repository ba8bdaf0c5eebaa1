#pragma once

#include "souple/contacts/contact.h"
#include "souple/contacts/surfaces/element_surfaces.h"
#include "souple/math/sentinels.h"
#include "souple/solver/projector.h"

#include <cstdint>
#include <span>
#include <vector>

namespace souple {

/// Bounds how far particles move in a substep, so that the search for pairs costs what the mesh costs and not what the
/// speed costs. A group of surfaces has no limit until a search of it for one substep finds more pairs than its budget.
/// Then the motions m of its surfaces are shortened in the frame of the velocity u:
///
///   m' = u h + (m - u h) min(1, L / |m - u h|)
///
/// u is the mean velocity of the slowest of these surfaces, so that objects that fly together are not slowed. It is 0
/// if a particle is held in place. L is halved until a search stays within its budget. Driven particles are shortened as
/// well, all of a surface by one factor. They lag behind, and catch up when they are slower.
class MotionLimit {
 public:
  using Group = std::span<const std::uint32_t>;  ///< surfaces that may touch each other, ascending

  /// No limit, until one is needed in this step.
  void begin_step(const ElementSurfaces& surfaces);
  bool is_active(std::uint32_t surface) const { return states_[surface].length < infinity; }
  /// Whether the group needed a limit or a frame in this step.
  bool is_needed(Group group) const { return states_[group[0]].has_frame; }
  /// Whether a limit or a frame of a part of the group does not hold for the rest.
  bool differs(Group group) const;
  /// Call before a search of all pairs of a group. Finds u again if it was needed in this step: what flew may have been
  /// stopped since. If surfaces differ, the shortest length holds for all.
  void begin_search(const ElementSurfaces& surfaces, Group group, const ParticleView& particles,
                    std::span<const Vec4f> velocity);

  /// Call after a search for one substep of length `h` found too many pairs. Limits the group by the greatest length that
  /// may suffice. Returns false if a shorter length would not matter. The search then has to find all pairs.
  bool shorten(const ElementSurfaces& surfaces, Group group, const ParticleView& particles,
               std::span<const Vec4f> velocity, float h);
  /// Per particle of the group: velocity with which it moves by its shortened motion in `h` [m/s]. The span is valid until
  /// the next call.
  std::span<const Vec4f> limited(const ElementSurfaces& surfaces, Group group, const ParticleView& particles,
                                 std::span<const Vec4f> velocity, float h);
  /// Shortens the motions of a group since the substep's start, and records the fastest one.
  void apply(const ElementSurfaces& surfaces, Group group, const ParticleView& particles, float h);

  /// The velocity u of a surface that may touch others [m/s].
  Vec3f frame(std::uint32_t surface) const { return states_[surface].frame; }
  /// The fastest motion that was shortened in this step; speed 0: none.
  const ShortenedMotion& shortened() const { return shortened_; }
  std::size_t bytes() const;

 private:
  struct State {
    float length = infinity;  // L [m]
    float mean_edge = 0;      // of the group [m]
    bool has_frame = false;   // it was needed in this step
    Vec3f frame;              // u [m/s]; 0 until it is needed
    bool operator==(const State& other) const {
      return length == other.length && has_frame == other.has_frame && frame == other.frame;
    }
  };
  void find_frame(const ElementSurfaces& surfaces, Group group, const ParticleView& particles,
                  std::span<const Vec4f> velocity);
  template <class Motion>
  float driven_factor(const ElementSurfaces& surfaces, std::uint32_t surface, const ParticleView& particles,
                      const Motion& motion, float time, float limit) const;

  std::vector<State> states_;  // per surface
  std::vector<Vec4f> limited_velocity_;
  ShortenedMotion shortened_;
};

}  // namespace souple
