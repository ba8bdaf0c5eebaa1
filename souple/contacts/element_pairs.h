#pragma once

#include "souple/broad_phase/contact_surface.h"
#include "souple/broad_phase/near_pairs.h"
#include "souple/contacts/contact.h"
#include "souple/contacts/kernels/element_pairs.h"
#include "souple/solver/projector.h"
#include "souple/threads/threads.h"

#include <array>
#include <span>
#include <vector>

namespace souple {

class IntersectionResolver;

/// Candidate pairs of elements, vertex and triangle or edge and edge, that may come into contact in a step.
///
/// One search a step finds them with boxes swept along the velocities (near_pairs.h). Boxes for
/// self-collision are relative to the object's mean motion: a heap that falls as a whole has no more pairs
/// than one at rest. Each particle is predicted on a straight path, within a margin. A pair is kept if its
/// relative velocity and its margins can bring it into contact. Where particles move by many times their
/// thickness within a step, a search covers only a part of the step, and another one follows. When particles
/// leave their paths, only their pairs are searched again. The new pairs follow the existing pairs and
/// replace the earlier pairs of those particles.
class ElementPairs {
 public:
  /// Replaces all surfaces: call it again when objects are added, removed or changed.
  void set_surfaces(std::vector<ContactSurface> surfaces);
  /// Sets the end of a surface that consists of particles alone, from the next step on: at most its
  /// reserved_end.
  void set_end(std::size_t surface, std::uint32_t end);
  /// Sets the pairs of particles with a distance joint. Elements with a particle each of such a pair get no
  /// contact.
  void exclude(std::vector<std::array<std::uint32_t, 2>> pairs);
  /// Sets the object whose exempt pairs are skipped; null: none are. It must outlive this object.
  void set_intersection_resolver(const IntersectionResolver* intersection_resolver) {
    intersection_resolver_ = intersection_resolver;
  }

  /// Finds pairs for a step of `dt`. radius[i]: half the thickness of particle i [m]. contact_margin[i]:
  /// additional distance at which contacts of particle i begin [m]. All spans must live until the step ends.
  void begin_step(const ParticleView& particles, std::span<const Vec4f> velocity,
                  std::span<const float> radius, std::span<const float> contact_margin,
                  const ContactStep& step, Threads& threads);
  /// Starts the next substep, of length `h` [s].
  void begin_substep(float h) { remaining_ -= h, covered_ -= h, elapsed_ += h; }
  /// Searches again for the pairs of particles that have left their paths within the substep of length `h`.
  /// Returns the index of the first new pair: size() if there is none, 0 if all pairs are new.
  std::size_t update(const ParticleView& particles, float h, Threads& threads);
  /// As above, if only `particles_moved` have moved since the last update.
  std::size_t update(const ParticleView& particles, float h, std::span<const std::uint32_t> particles_moved,
                     Threads& threads);
  void clear();

  /// Whether any surface may collide with another one or with itself.
  bool any() const { return any_; }
  std::size_t size() const { return particle_.size(); }
  /// Consecutive pairs of one kind, which are tested or skipped together.
  struct Chunk {
    std::uint32_t begin = 0, end = 0;
    std::uint32_t blocks = 0;  // number of entries in blocks_; too_many: more than max_blocks
    bool edges = false, inter_object = false;
    float min_distance_bound = 0, min_gap_bound = 0;  // of its pairs, when they were last tested [m]
    float motion_since = 0;                           // motion bound since that test [m]
  };
  std::size_t chunk_count() const { return chunks_.size(); }
  const Chunk& chunk(std::size_t index) const { return chunks_[index]; }
  static constexpr std::size_t chunk_size = 512;  ///< greatest number of pairs in a chunk
  /// Measures the motion of all particles since the substep began. Call it before find_near, and again
  /// whenever particles were moved.
  void measure(const ParticleView& particles, Threads& threads);
  /// As above, for `particles_moved` alone: the particles that were moved since the last call.
  void measure(const ParticleView& particles, std::span<const std::uint32_t> particles_moved);
  /// Whether a pair has a particle of the last `particles_moved`.
  bool was_moved(std::size_t pair) const {
    const auto& i = particle_[pair].particle;
    return (was_moved_[i[0]] | was_moved_[i[1]] | was_moved_[i[2]] | was_moved_[i[3]]) != 0;
  }
  /// Whether a chunk may have a pair with was_moved() whose relative motion is at least `part` of its
  /// distance.
  bool any_moved_by(float part, const Chunk& chunk) const;
  /// Largest contact margin of a chunk's particles at the last measurement of all particles [m].
  float contact_margin(std::size_t chunk) const;
  /// Writes the indices of a chunk's pairs that come near (kernels::NearRule) to `found`, ascending. Returns
  /// their number.
  std::size_t find_near(std::size_t chunk, const kernels::NearRule& rule,
                        const kernels::ParticleRecords& records, std::uint32_t* found);
  /// Adds the motion of the last measurement to the motion bounds of all chunks.
  void end_substep();
  /// Input of the kernels; `moved` is the motion of the last measurement.
  kernels::ParticleRecords particle_records(const ParticleView& particles) const;
  bool are_edges(std::size_t pair) const { return is_edges_[pair] != 0; }
  /// Whether pairs of a later search replace this pair.
  bool is_replaced(std::size_t pair) const {
    const auto& i = particle_[pair].particle;
    return pair < valid_from_[i[0]] || pair < valid_from_[i[1]] || pair < valid_from_[i[2]] ||
           pair < valid_from_[i[3]];
  }
  const NearPair& pair(std::size_t index) const { return particle_[index]; }
  /// Lower bound of the distance of a pair that find_near returned, at the substep's start [m].
  float distance_bound(std::size_t pair) const { return distance_bound_[pair]; }
  kernels::ElementPairColumns columns();

  std::size_t particle_count() const { return surface_of_.size(); }
  std::uint32_t surface_of(std::uint32_t particle) const { return surface_of_[particle]; }
  const ContactSurface& surface(std::size_t index) const { return surfaces_[index]; }
  std::size_t surface_count() const { return surfaces_.size(); }
  std::size_t bytes() const;

 private:
  /// Pairs of a batch, as columns.
  struct List {
    std::vector<NearPair> particle;
    std::vector<float> thickness, distance_bound;
    std::size_t count = 0, offset = 0;  // offset: in the columns of all pairs
    void add(const NearPair& pair, float pair_thickness, float distance) {
      particle[count] = pair, thickness[count] = pair_thickness, distance_bound[count] = distance;
      ++count;
    }
  };
  /// Pairs of a part of the search: those that are near already, and the far ones, which are seldom tested.
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
  bool collides_with_other(std::uint32_t a, std::uint32_t b) const {
    return a != b && may_collide(surfaces_, a, b);
  }
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
  ParticlePairs excluded_;                 // in both orders, sorted
  std::vector<std::uint32_t> surface_of_;  // per particle: its surface, or no_surface
  std::vector<Vec4f> rest_;          // per particle: rest position relative to its surface's first one [m]
  std::vector<float> longest_edge_;  // per surface: longest edge at rest [m]
  // Elements of the surfaces with self-collision, and of the surfaces with overlaps_other_.
  SurfaceElements self_elements_, inter_object_elements_;
  std::vector<Bounds> surface_bounds_;  // per surface: around its particles' boxes, with a margin
  // Per surface: its bounds overlap those of a surface that it may collide with.
  std::vector<std::uint8_t> overlaps_other_now_, overlaps_other_;
  BoxSweep surface_sweep_;
  bool any_ = false;

  std::span<const float> radius_, contact_margin_;
  ContactStep step_;
  float remaining_ = 0;                 // time of the step after this substep [s]
  float covered_ = 0;                   // time after this substep that the last search covers [s]
  std::vector<Vec3f> mean_velocity_;    // per surface: when pairs were found [m/s]
  std::vector<Vec3d> mean_position_;    // per surface: mean of sampled particles, when pairs were found [m]
  std::vector<Vec3f> shift_;            // per surface: motion of that mean since then [m]
  std::vector<Vec3f> saved_shift_;      // shift_, while particles are at the substep's start [m]
  std::vector<Bounds> boxes_;           // per particle: swept in world space
  std::vector<Bounds> relative_boxes_;  // per particle: swept relative to its surface's mean motion
  /// Predicted positions of a particle at the time t since pairs were found [m]: within `margin` of
  /// origin + v t in world space, and within `relative_margin` of relative_origin + (v - mean_velocity) t
  /// relative to its surface's shift.
  struct PredictedPath {
    Vec3f origin, relative_origin;
    float margin, relative_margin;
    float valid_until;  // end of the time that the search covers, since pairs were found [s]
  };
  std::vector<PredictedPath> path_;
  std::vector<Vec4f> predicted_velocity_;  // per particle: v above [m/s]
  float elapsed_ = 0;                      // from the last search of all pairs to the substep's end [s]
  NearPairFinder self_finder_, inter_object_finder_;
  NearPairs self_pairs_, inter_object_pairs_;
  std::vector<std::vector<std::uint32_t>> off_path_of_chunk_;  // off_path_, by chunks of particles
  std::vector<std::uint32_t> off_path_;                        // particles that have left their paths
  std::vector<std::uint32_t> valid_from_;  // per particle: its pairs with a lower index are replaced
  std::vector<Batch> batches_;
  std::vector<Chunk> chunks_;
  // Per particle, for a search within a step: mean velocity in the substep [m/s], state at its start.
  std::vector<Vec4f> velocity_now_, before_;
  std::vector<NearPair> particle_;
  std::vector<float> thickness_, distance_bound_;
  std::vector<std::uint8_t> is_edges_;
  static constexpr std::size_t block_size = 64;  // consecutive particles in a block
  static constexpr std::uint32_t max_blocks = 48, too_many = max_blocks + 1;
  std::vector<std::array<std::uint32_t, max_blocks>> blocks_;  // per chunk: blocks with its particles
  std::vector<Vec4f> moved_;        // per particle: motion since the substep began [m]
  std::vector<Vec3f> mean_motion_;  // per surface: mean of sampled particles' motions [m]
  // Per block: largest motion of its particles, in world space and relative to their mean_motion_ [m].
  std::vector<float> block_motion_, block_relative_motion_;
  std::vector<std::uint8_t> was_moved_;    // per particle: whether it is in remeasured_
  std::vector<std::uint32_t> remeasured_;  // `particles_moved` of the last measure()
  float max_motion_ = 0, max_relative_motion_ = 0;
  std::vector<float> block_contact_margin_;  // per block: largest contact margin [m]
  float max_contact_margin_ = 0;
};

inline constexpr std::uint32_t no_surface = ~0u;
inline constexpr float min_thickness = 1e-5f;  // m
/// Speculative margin, as a part of the thickness: contacts exist before elements are near enough for a
/// correction, because the solver moves them too.
inline constexpr float speculative_part = 0.1f;

}  // namespace souple
