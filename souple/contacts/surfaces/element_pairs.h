#pragma once

#include "souple/broad_phase/near_pair.h"
#include "souple/contacts/contact.h"
#include "souple/contacts/surfaces/element_surfaces.h"
#include "souple/contacts/surfaces/motion_bounds.h"
#include "souple/contacts/surfaces/motion_limit.h"
#include "souple/contacts/surfaces/pair_chunks.h"
#include "souple/contacts/surfaces/predicted_paths.h"
#include "souple/solver/projector.h"
#include "souple/state/columns.h"
#include "souple/threads/threads.h"

#include <memory>
#include <span>
#include <vector>

namespace souple {

class IntersectionResolver;
class PairSearch;
struct PairSearchInput;

/// A contact or a TOI violation: the index of a candidate pair, and the part of the motion at which its nearest
/// points count. This is its time of impact, or 1 without impact.
struct PairToi {
  std::uint32_t pair;
  float toi;
};
using SurfaceContactRows = ColumnStore<kernels::ContactColumns>;
/// Part of the number of contacts that is reserved beyond it: the number changes fast.
inline constexpr double contact_spare = SurfaceContactRows::spare;

/// Candidate pairs of elements, vertex and triangle or edge and edge, that may come into contact in a step.
///
/// One search a step finds them with boxes swept along the velocities (predicted_paths.h, near_pairs.h). A pair is
/// kept if its relative velocity and its margins can bring it into contact. Particles of a surface may move by many times
/// their thickness within a step. A search then covers a part of the step, and another one of that surface follows. When
/// particles leave their paths, only their pairs are searched again, or those of their surface if they are many. The new
/// pairs follow the existing pairs and replace the earlier pairs of those particles. Chunks of pairs that cannot touch yet
/// are skipped (motion_bounds.h).
///
/// The order of a surface's pairs, and when they are searched, depend on no surface that it cannot touch
/// (surface_groups.h).
///
/// The number of a group's pairs is bounded in proportion to the number of its elements. A search that exceeds its budget
/// is repeated for one substep alone, and then for shortened motions (motion_limit.h).
class ElementPairs {
 public:
  ElementPairs();
  /// Skips the pairs that the resolver exempts; null: none. It must outlive this object.
  ElementPairs(std::vector<ContactSurface> surfaces, ParticlePairs joined,
               const IntersectionResolver* intersection_resolver);
  ElementPairs(ElementPairs&&) noexcept;
  ElementPairs& operator=(ElementPairs&&) noexcept;
  ~ElementPairs();
  void set_end(std::size_t surface, std::uint32_t end) { surfaces_.set_end(surface, end); }

  /// Finds pairs for a step of `dt`. radius[i]: half the thickness of particle i [m]. contact_margin[i]:
  /// additional distance at which contacts of particle i begin [m]. All spans must live until the step ends. still[a]: see
  /// PredictedPaths.
  void begin_step(const ParticleView& particles, std::span<const Vec4f> velocity,
                  std::span<const float> radius, std::span<const float> contact_margin,
                  std::span<const std::uint8_t> still, const ContactStep& step, Threads& threads);
  /// Starts the next substep, of length `h` [s]. `still_have_margins`: particles of surfaces that are still may have contact
  /// margins.
  void begin_substep(float h, bool still_have_margins);
  /// Searches again for the pairs of particles that have left their paths within the substep of length `h`. Shortens
  /// motions while there is a limit.
  /// Returns the index of the first new pair: size() if there is none, 0 if all pairs are new.
  std::size_t update(const ParticleView& particles, float h, Threads& threads);
  /// Updates after `particles_moved` alone have moved since the last update.
  std::size_t update(const ParticleView& particles, float h, std::span<const std::uint32_t> particles_moved,
                     Threads& threads);
  /// Drops pairs that later searches replaced, if they may be a third of all. Call between substeps: what is known of pairs by
  /// their index changes. Returns the former indices of the others, ascending, or nothing if none were dropped.
  std::span<const std::uint32_t> drop_replaced(Threads& threads);
  /// Particles of the surfaces all of whose pairs are new since the last call, if not all pairs are.
  std::span<const IndexRange> take_searched_anew();
  void clear() { pairs_.clear(); }
  /// The fastest motion that was shortened in this step; speed 0: none.
  const ShortenedMotion& shortened() const { return limit_.shortened(); }

  const ElementSurfaces& surfaces() const { return surfaces_; }
  std::size_t size() const { return pairs_.size(); }
  const NearPair& pair(std::size_t index) const { return pairs_.pair(index); }
  bool are_edges(std::size_t pair) const { return pairs_.are_edges(pair); }
  bool is_replaced(std::size_t pair) const { return pairs_.is_replaced(pair); }
  /// Lower bound of the distance of a pair that find_near returned, at the substep's start [m].
  float distance_bound(std::size_t pair) const { return pairs_.distance_bound(pair); }
  kernels::ElementPairColumns columns() { return pairs_.columns(); }

  using Chunk = PairChunks::Chunk;
  static constexpr std::size_t chunk_size = PairChunks::chunk_size;
  std::size_t chunk_count() const { return pairs_.chunks().size(); }
  const Chunk& chunk(std::size_t index) const { return pairs_.chunks()[index]; }
  /// Measures the motion of all particles since the substep began. Call it before find_near, and again
  /// whenever particles were moved.
  void measure(const ParticleView& particles, Threads& threads) {
    bounds_.measure(surfaces_, particles, paths_.contact_margin(), threads);
  }
  /// Measures `particles_moved` alone: the particles that were moved since the last call.
  void measure(const ParticleView& particles, std::span<const std::uint32_t> particles_moved) {
    bounds_.measure(surfaces_, particles, particles_moved);
  }
  /// Whether a pair has a particle of the last `particles_moved`.
  bool was_moved(std::size_t pair) const { return bounds_.was_moved(pairs_.pair(pair)); }
  /// Writes the indices of a chunk's pairs with was_moved() whose relative motion is at least `part` of their distance to
  /// `found`, ascending. Returns their number.
  std::size_t find_moved_by(float part, std::size_t chunk, const kernels::ParticleRecords& records,
                            std::uint32_t* found);
  /// Largest contact margin of a chunk's particles at the last measurement of all particles [m].
  float contact_margin(std::size_t index) const { return bounds_.contact_margin(index, chunk(index)); }
  /// Writes the indices of a chunk's pairs that come near (kernels::NearRule) to `found`, ascending. Returns
  /// their number.
  std::size_t find_near(std::size_t chunk, const kernels::NearRule& rule,
                        const kernels::ParticleRecords& records, std::uint32_t* found);
  /// Adds the motion of the last measurement to the motion bounds of all chunks.
  void end_substep();
  /// Input of the kernels; `moved` is the motion of the last measurement.
  kernels::ParticleRecords particle_records(const ParticleView& particles) const;
  std::size_t bytes() const;

 private:
  using List = PairChunks::List;
  using Batch = PairChunks::Batch;

  /// State of a surface in a step.
  struct Search {
    float covered = 0;         ///< time after this substep that its last search covers [s]
    std::size_t found = 0;     ///< pairs since the last search of all its pairs
    std::size_t added = 0;     ///< pairs since the substep began
    std::size_t off_path = 0;  ///< particles that have left their paths
    bool again = false;        ///< all its pairs are searched again
  };
  /// Paths are predicted from this state, so many seconds before the substep's end.
  struct Motion {
    const ParticleView& particles;
    std::span<const Vec4f> velocity;
    float ago;
    Threads& threads;
  };

  bool is_searched(std::uint32_t surface) const;
  PairSearchInput input(const Motion& motion) const;
  float substep_length() const { return step_.h > 0 ? min(step_.h, remaining_) : remaining_; }
  float horizon(std::size_t surface, const ParticleView& particles, std::span<const Vec4f> velocity) const;
  std::size_t refind(const ParticleView& particles, float h, bool may_be_over, Threads& threads);
  void choose_surfaces(float h, bool may_be_over);
  bool are_all_chosen(MotionLimit::Group group) const;
  bool choose_all(MotionLimit::Group group);
  bool choose_more();
  bool choose_over();
  ParticleView rewind(const ParticleView& particles, float h);
  void predict(std::uint32_t surface, const Motion& motion, bool one_substep);
  void predict_group(MotionLimit::Group group, const Motion& motion, bool one_substep);
  void predict_chosen(const Motion& motion);
  void predict_off_path(const Motion& motion);
  void list_moved();
  std::size_t replace(bool all);
  void shorten_motions(const ParticleView& particles, float h);
  void find_within_limit(std::uint32_t group, const Motion& motion);
  void add_found(const Motion& motion);
  void add(std::span<const NearPair> pairs, bool edges, bool inter_object, const Motion& motion);
  void add_batch(Batch& batch, std::span<const NearPair> pairs, bool edges, bool inter_object,
                 const ParticleView& particles) const;

  ElementSurfaces surfaces_;
  PredictedPaths paths_;
  MotionLimit limit_;
  PairChunks pairs_;
  MotionBounds bounds_;
  const IntersectionResolver* intersection_resolver_ = nullptr;
  ContactStep step_;
  float remaining_ = 0;           // time of the step after this substep [s]
  std::vector<Search> searches_;  // per surface
  std::unique_ptr<PairSearch> search_;
  std::vector<std::uint32_t> moved_;           // particles whose pairs are searched again
  std::vector<IndexRange> anew_, taken_anew_;  // see take_searched_anew
  std::vector<Batch> batches_;
  // Per particle, for a search within a step: mean velocity in the substep [m/s], state at its start.
  std::vector<Vec4f> velocity_now_, before_;
};

}  // namespace souple
