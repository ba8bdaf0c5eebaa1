#pragma once

#include "souple/contacts/surfaces/element_surfaces.h"
#include "souple/contacts/surfaces/pair_chunks.h"
#include "souple/solver/projector.h"
#include "souple/threads/threads.h"

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace souple {

/// Upper bounds of the motions of a chunk's pairs since their distances were last computed. While the bound is below the
/// smallest of these distances, no pair of the chunk can touch, and none is tested. A chunk lists the blocks of 64
/// consecutive particles that its pairs have; a block has the largest motion of its particles.
class MotionBounds {
 public:
  using Chunk = PairChunks::Chunk;
  MotionBounds() = default;
  /// `particles`: how many particles are measured.
  explicit MotionBounds(std::size_t particles) { remeasured_.reserve(particles); }

  /// still[a]: surface a does not move in this step.
  void begin_step(const ElementSurfaces& surfaces, std::span<const std::uint8_t> still);
  /// Whether particles of surfaces that are still may have contact margins.
  void set_still_have_margins(bool may) { still_have_margins_ = may; }
  /// Measures the motion of all particles since the substep began. contact_margin[i]: additional distance at which
  /// contacts of particle i begin [m].
  void measure(const ElementSurfaces& surfaces, const ParticleView& particles,
               std::span<const float> contact_margin, Threads& threads);
  /// Measures `particles_moved` alone: the particles that were moved since the last call.
  void measure(const ElementSurfaces& surfaces, const ParticleView& particles,
               std::span<const std::uint32_t> particles_moved);
  /// Per particle: motion of the last measurement [m].
  std::span<const Vec4f> moved() const { return moved_; }
  /// Whether a pair has a particle of the last `particles_moved`.
  bool was_moved(const NearPair& pair) const {
    const auto& i = pair.particle;
    return (was_moved_[i[0]] | was_moved_[i[1]] | was_moved_[i[2]] | was_moved_[i[3]]) != 0;
  }

  /// Whether a chunk may have such a pair.
  bool may_have_moved(std::size_t index, const Chunk& chunk) const;

  /// Lists the blocks of chunk `index`, whose pairs are new, and sets its smallest bounds.
  void add_chunk(std::size_t index, PairChunks& pairs);
  /// Makes room for the blocks of so many chunks.
  void resize(std::size_t chunks);
  /// Upper bound of the relative motions of a chunk's pairs in the last measurement, rounding included [m].
  float of_chunk(std::size_t index, const Chunk& chunk) const;
  /// Largest contact margin of a chunk's particles at the last measurement of all particles [m].
  float contact_margin(std::size_t index, const Chunk& chunk) const;
  /// Largest motion of a point of one element relative to a point of the other element [m].
  float of_pair(const NearPair& pair, bool edges) const;
  std::size_t bytes() const;

 private:
  static constexpr std::size_t block_size = 64;  // consecutive particles in a block
  static constexpr std::uint32_t max_blocks = 48, too_many = max_blocks + 1;
  std::vector<std::array<std::uint32_t, max_blocks>> blocks_;  // per chunk: blocks with its particles
  std::vector<Vec4f> moved_;
  std::vector<Vec3f> mean_motion_;  // per surface: mean of sampled particles' motions [m]
  // Per block: largest motion of its particles, in world space and relative to their mean_motion_ [m].
  std::vector<float> block_motion_, block_relative_motion_;
  std::vector<std::uint8_t> was_moved_;        // per particle: whether it is in remeasured_
  std::vector<std::uint8_t> block_was_moved_;  // per block: whether one of its particles is
  std::vector<std::uint32_t> remeasured_;      // `particles_moved` of the last measure()
  float max_motion_ = 0, max_relative_motion_ = 0;
  std::vector<std::uint8_t> block_is_still_, block_was_still_;  // in this step, in the last one
  std::vector<float> block_contact_margin_;                     // per block: largest contact margin [m]
  float max_contact_margin_ = 0;
  bool still_have_margins_ = true;
};

}  // namespace souple
