#pragma once

#include "souple/collision/contact.h"
#include "souple/collision/contact_surface.h"
#include "souple/collision/kernels/element_pairs.h"
#include "souple/collision/near_pairs.h"
#include "souple/solver/projector.h"
#include "souple/solver/threads.h"

#include <array>
#include <span>
#include <vector>

namespace souple {

class IntersectionResolver;

/// Vertices and triangles, and edges and edges, that may touch within a step.
///
/// They are looked for once a step, in boxes swept by the velocities (near_pairs.h), those of one object
/// relative to its mean motion: a heap that falls as one has no more pairs than one at rest. A particle is
/// expected on a straight way, with some room around it; what two features can come nearer follows from their
/// relative velocity and their rooms. Where particles move by many times their thickness within a step, pairs
/// are found for a part of it, and again when that is over. When some particles have left their ways, theirs
/// are found again: they follow the others, and take the place of those that these particles had.
class ElementPairs {
 public:
  /// What can touch, anew when objects came, went or changed.
  void set_surfaces(std::vector<ContactSurface> surfaces);
  /// The loose particles of a surface end here from the next step on, at most at its reserved end.
  void set_end(std::size_t surface, std::uint32_t end);
  /// Pairs of particles that are tied together: features that have one each never touch.
  void exclude(std::vector<std::array<std::uint32_t, 2>> pairs);
  /// Whose tangles are left out; none: nothing is. It must live as long as this is used.
  void set_intersection_resolver(const IntersectionResolver* intersection_resolver) {
    intersection_resolver_ = intersection_resolver;
  }

  /// Finds pairs for a step of `dt`. radius[i]: half the thickness of particle i, pressed[i]: how much
  /// farther it has to be apart to be passed over [m]. All spans must live until the step ends.
  void begin_step(const ParticleView& particles, std::span<const Vec4f> velocity,
                  std::span<const float> radius, std::span<const float> contact_margin,
                  const ContactStep& step, Threads& threads);
  /// The next substep of `h` begins.
  void begin_substep(float h) { remaining_ -= h, covered_ -= h, elapsed_ += h; }
  /// Finds pairs again where particles have left their ways within the substep of `h`. Returns from where on
  /// pairs are new: size() where none are, 0 where all are.
  std::size_t update(const ParticleView& particles, float h, Threads& threads);
  /// The same when only `particles_moved` were moved since the last.
  std::size_t update(const ParticleView& particles, float h, std::span<const std::uint32_t> particles_moved,
                     Threads& threads);
  void clear();

  /// Whether there are surfaces that may meet at all.
  bool any() const { return any_; }
  std::size_t size() const { return particle_.size(); }
  /// Neighboring pairs of one kind, which are looked at or passed over together.
  struct Chunk {
    std::uint32_t begin = 0, end = 0;
    std::uint32_t blocks = 0;  // how many of its places in blocks_ are taken; too_many: not all fit
    bool edges = false, inter_object = false;
    float min_distance_bound = 0, min_gap_bound = 0;  // when they were last looked at [m]
    float motion_since = 0;                           // what they may have moved since [m]
  };
  std::size_t chunk_count() const { return chunks_.size(); }
  const Chunk& chunk(std::size_t index) const { return chunks_[index]; }
  static constexpr std::size_t chunk_size = 512;  ///< most pairs of a chunk
  /// What every particle has moved since the substep began: before `near`, and again whenever some were
  /// moved.
  void measure(const ParticleView& particles, Threads& threads);
  /// The same when only some were moved since: of these alone.
  void measure(const ParticleView& particles, std::span<const std::uint32_t> particles_moved);
  /// Whether a pair has a particle that was measured by itself.
  bool was_moved(std::size_t pair) const {
    const auto& i = particle_[pair].particle;
    return (was_moved_[i[0]] | was_moved_[i[1]] | was_moved_[i[2]] | was_moved_[i[3]]) != 0;
  }
  /// Whether a chunk has such a pair that goes `part` of what its features are apart, or may do so.
  bool any_moved_by(float part, const Chunk& chunk) const;
  /// The most that particles of a chunk are pressed, as when it was measured last. [m]
  float contact_margin(std::size_t chunk) const;
  /// Of a chunk, by pairs that come near (kernels::NearRule), `found` of them ascending; returns how many.
  std::size_t find_near(std::size_t chunk, const kernels::NearRule& rule,
                        const kernels::ParticleRecords& records, std::uint32_t* found);
  /// What was measured last is what the substep has done.
  void end_substep();
  /// For kernels. `moved` is what was measured last.
  kernels::ParticleRecords particle_records(const ParticleView& particles) const;
  bool are_edges(std::size_t pair) const { return is_edges_[pair] != 0; }
  /// Another pair, found later, stands for it.
  bool is_replaced(std::size_t pair) const {
    const auto& i = particle_[pair].particle;
    return pair < valid_from_[i[0]] || pair < valid_from_[i[1]] || pair < valid_from_[i[2]] ||
           pair < valid_from_[i[3]];
  }
  const NearPair& pair(std::size_t index) const { return particle_[index]; }
  /// They were at least so far apart when the substep began. [m]
  float distance_bound(std::size_t pair) const { return distance_bound_[pair]; }
  kernels::ElementPairColumns columns();

  std::size_t particle_count() const { return surface_of_.size(); }
  std::uint32_t surface_of(std::uint32_t particle) const { return surface_of_[particle]; }
  const ContactSurface& surface(std::size_t index) const { return surfaces_[index]; }
  std::size_t surface_count() const { return surfaces_.size(); }
  std::size_t bytes() const;

 private:
  /// Some of the pairs that were found.
  struct List {
    std::vector<NearPair> particle;
    std::vector<float> thickness, distance_bound;
    std::size_t count = 0, offset = 0;  // in the columns
    void add(const NearPair& pair, float thick, float apart) {
      particle[count] = pair, thickness[count] = thick, distance_bound[count] = apart;
      ++count;
    }
  };
  /// Those among some neighbors that are near already, and the others: these are seldom looked at.
  struct Batch {
    List near, far;
  };
  using ParticlePairs = std::vector<std::array<std::uint32_t, 2>>;

  void find(const ParticleView& particles, std::span<const Vec4f> velocity, Threads& threads);
  float horizon(const ParticleView& particles, std::span<const Vec4f> velocity) const;
  ParticleView rewind(const ParticleView& particles, float h);
  void refind_all(const ParticleView& before, float h, Threads& threads);
  void refind_off_path(const ParticleView& before, float h, Threads& threads);
  void predict(std::uint32_t particle, const Vec3f& x, const Vec3f& v, float since, float dt, float margin);
  bool is_on_path(std::uint32_t particle, const Vec3f& x) const;
  void find_means(const ParticleView& particles, std::span<const Vec4f> velocity);
  void predict_all(const ParticleView& particles, std::span<const Vec4f> velocity, float dt,
                   Threads& threads);
  void find_shift(const ParticleView& particles);
  void select_inter_object_elements();
  Vec3d mean_position(const ContactSurface& surface, const ParticleView& particles) const;
  void find_off_path(const ParticleView& particles, Threads& threads);
  std::size_t refind(const ParticleView& particles, float h, bool over, Threads& threads);
  bool is_excluded(const NearPair& pair, bool edges) const;
  void add_found(const ParticleView& particles, float dt, Threads& threads);
  void add(std::span<const NearPair> pairs, bool edges, bool inter_object, const ParticleView& particles,
           float dt, Threads& threads);
  void add_batch(Batch& batch, std::span<const NearPair> pairs, bool edges, bool inter_object,
                 const ParticleView& particles, float dt) const;
  void limit_to_rest_distance(List& list, bool edges) const;
  void append(List Batch::*list, std::size_t batches, bool edges, bool inter_object, Threads& threads);
  void measure_new_chunks(std::size_t first, Threads& threads);
  float motion_bound(const Chunk& chunk) const;
  float relative_motion(const NearPair& pair, bool edges) const;

  std::vector<ContactSurface> surfaces_;
  const IntersectionResolver* intersection_resolver_ = nullptr;
  ParticlePairs excluded_;                 // both ways, sorted
  std::vector<std::uint32_t> surface_of_;  // of each particle; no_surface where it has none
  std::vector<Vec4f> rest_;                // of each particle, relative to the first of its surface
  std::vector<float> longest_edge_;        // of each surface at rest [m]
  SurfaceElements self_elements_,
      inter_object_elements_;  // of those that meet themselves; of those that may meet another now
  std::vector<Bounds> surface_bounds_;
  std::vector<std::uint8_t> overlaps_other_now_, overlaps_other_;  // which those are
  ObjectMatrix self_matrix_, inter_object_matrix_;
  bool any_ = false;

  std::span<const float> radius_, contact_margin_;
  ContactStep step_;
  float remaining_ = 0;                 // of the step, behind this substep [s]
  float covered_ = 0;                   // the same of what boxes were swept for
  std::vector<Vec3f> mean_velocity_;    // mean velocity of each surface when pairs were found [m/s]
  std::vector<Vec3d> mean_position_;    // of some of its particles, then [m]
  std::vector<Vec3f> shift_;            // of the same since then, as ways are compared with it [m]
  std::vector<Vec3f> saved_shift_;      // the same, while particles are where the substep began
  std::vector<Bounds> boxes_;           // of particles, swept in the world
  std::vector<Bounds> relative_boxes_;  // and relative to the frame of their surface
  /// Where a particle is expected t after pairs were found: within room of from + v t in the world, and of
  /// own_from + (v - frame) t relative to its surface's shift. [m]
  struct PredictedPath {
    Vec3f origin, relative_origin;
    float margin, relative_margin;
    float valid_until;  // pairs were looked for up to then, since pairs were found [s]
  };
  std::vector<PredictedPath> path_;
  std::vector<Vec4f> predicted_velocity_;  // v [m/s]
  float elapsed_ = 0;                      // since pairs were found, at the end of the substep [s]
  NearPairFinder self_finder_, inter_object_finder_;
  NearPairs self_pairs_, inter_object_pairs_;
  std::vector<std::vector<std::uint32_t>> off_path_of_chunk_;  // particles that have left their ways
  std::vector<std::uint32_t> off_path_;
  std::vector<std::uint32_t> valid_from_;  // of each particle: its pairs before this one are replaced
  std::vector<Batch> batches_;
  std::vector<Chunk> chunks_;
  std::vector<Vec4f> velocity_now_, before_;  // when pairs are found within a step
  std::vector<NearPair> particle_;
  std::vector<float> thickness_, distance_bound_;
  std::vector<std::uint8_t> is_edges_;
  static constexpr std::size_t block_size = 64;  // neighboring particles
  static constexpr std::uint32_t max_blocks = 48, too_many = max_blocks + 1;
  std::vector<std::array<std::uint32_t, max_blocks>> blocks_;  // where the particles of each chunk are
  std::vector<Vec4f> moved_;                                   // of each particle [m]
  std::vector<Vec3f> mean_motion_;                             // of each surface
  std::vector<float> block_motion_, block_relative_motion_;  // the farthest in each block; without that mean
  std::vector<std::uint8_t> was_moved_;                      // particles that were measured by themselves
  std::vector<std::uint32_t> remeasured_;                    // which those are
  float max_motion_ = 0, max_relative_motion_ = 0;
  std::vector<float> block_contact_margin_;  // the most of each block [m]
  float max_contact_margin_ = 0;
};

inline constexpr std::uint32_t no_surface = ~0u;
inline constexpr float min_thickness = 1e-5f;  // m
/// Contacts are made somewhat before features are near enough to push: the solver moves them too. A part of
/// their thickness.
inline constexpr float speculative_part = 0.1f;

}  // namespace souple
