#pragma once

#include "souple/contacts/contact.h"
#include "souple/contacts/surfaces/element_surfaces.h"
#include "souple/solver/projector.h"
#include "souple/threads/threads.h"

#include <cstdint>
#include <limits>
#include <span>
#include <vector>

namespace souple {

/// Bounds how far particles move in a substep, so that the search for pairs costs what the mesh costs and not what the
/// speed costs. There is no limit until a search for one substep finds more pairs than its budget. Then the motions m of
/// the surfaces that were searched are shortened in the frame of the velocity u:
///
///   m' = u h + (m - u h) min(1, L / |m - u h|)
///
/// u is the mean velocity of the slowest of these surfaces, so that objects that fly together are not slowed. It is 0
/// if a particle is held in place. A surface that only collides with itself has its own mean velocity as u. L is halved
/// until a search stays within its budget. Driven particles are shortened as well, all of a surface by one factor. They
/// lag behind, and catch up when they are slower.
class MotionLimit {
 public:
  /// No limit, until one is needed in this step.
  void begin_step(const ElementSurfaces& surfaces);
  bool is_active() const { return length_ < std::numeric_limits<float>::infinity(); }

  /// Call after a search for one substep of length `h` found too many pairs. Limits the surfaces with overlaps_other
  /// and those with self-collision by the greatest length that may suffice. Returns false if a shorter length would not
  /// matter. The search then has to find all pairs.
  bool shorten(const ElementSurfaces& surfaces, std::span<const std::uint8_t> overlaps_other,
               const ParticleView& particles, std::span<const Vec4f> velocity, float h);
  /// Per particle: velocity with which it moves by its shortened motion in `h` [m/s]. The span is valid until the next
  /// call.
  std::span<const Vec4f> limited(const ElementSurfaces& surfaces, const ParticleView& particles,
                                 std::span<const Vec4f> velocity, float h);
  /// Finds u again if it was needed in this step: what flew may have been stopped since.
  void update_frame(const ElementSurfaces& surfaces, std::span<const std::uint8_t> overlaps_other,
                    const ParticleView& particles, std::span<const Vec4f> velocity) {
    if (has_frame_) find_frame(surfaces, overlaps_other, particles, velocity);
  }
  /// Shortens the motions since the substep's start, and records the fastest one.
  void apply(const ElementSurfaces& surfaces, const ParticleView& particles, float h, Threads& threads);

  /// u of the surfaces that may touch each other [m/s].
  const Vec3f& frame() const { return common_frame_; }
  /// The fastest motion that was shortened in this step; speed 0: none.
  const ShortenedMotion& shortened() const { return shortened_; }
  std::size_t bytes() const;

 private:
  struct Largest {
    float squared = 0;
    std::uint32_t particle = 0;
  };
  bool is_limited(std::uint32_t surface) const { return surface != no_surface && limits_[surface] != 0; }
  template <class Motion>
  void find_driven_factors(const ElementSurfaces& surfaces, const ParticleView& particles,
                           const Motion& motion, float time, float limit);
  float factor(const ParticleView& particles, std::uint32_t particle, std::uint32_t surface,
               const Vec3f& motion, float limit) const;
  void find_frame(const ElementSurfaces& surfaces, std::span<const std::uint8_t> overlaps_other,
                  const ParticleView& particles, std::span<const Vec4f> velocity);

  float length_ = std::numeric_limits<float>::infinity();  // L [m]
  float mean_edge_ = 0;                                    // of the limited surfaces [m]
  bool has_frame_ = false;
  std::vector<std::uint8_t> limits_;  // per surface: whether it is limited
  Vec3f common_frame_;
  std::vector<Vec3f> frame_;          // per surface: u [m/s]
  std::vector<float> driven_factor_;  // per surface: of its driven particles
  std::vector<Vec4f> limited_velocity_;
  std::vector<Largest> largest_of_chunk_;
  ShortenedMotion shortened_;
};

}  // namespace souple
