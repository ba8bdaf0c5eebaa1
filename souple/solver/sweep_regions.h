#pragma once

#include "souple/math/disjoint_sets.h"
#include "souple/solver/projector.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

namespace souple {

/// Regions whose projectors need equally many sweeps.
struct SweepClass {
  std::vector<int> sweeps;                  ///< per projector
  std::vector<IndexRange> particles;        ///< of the regions' objects, ascending
  std::vector<std::vector<SweptRun>> runs;  ///< per projector: the regions' constraints
};

/// Regions: objects that constraints connect in a substep. No region sees another, so each is swept as often as it needs: a
/// stiff body changes nothing for what it does not touch.
class SweepRegions {
 public:
  using ObjectPair = std::pair<std::uint32_t, std::uint32_t>;
  /// Call when objects or constraints changed. `objects`: their particles, ascending. `joined`: objects that constraints
  /// other than contacts connect.
  void set_objects(std::span<const IndexRange> objects, std::vector<ObjectPair> joined);
  /// Call when the contacts of a substep are found.
  void begin_substep() { found_ = false; }

  /// Divides the regions into classes. Fewer than two: all constraints belong to one.
  std::span<const SweepClass> classes(std::span<Projector* const> projectors, const ParticleView& particles,
                                      const Substep& substep);
  /// Chooses no region, then those of particles.
  void choose_none(std::span<Projector* const> projectors, const ParticleView& particles);
  void choose(std::uint32_t particle) { chosen_[root_of(particle)] = 1; }
  /// The constraints of a projector in chosen regions.
  void list_chosen(const Projector& projector, const ParticleView& particles, std::vector<SweptRun>& runs);
  /// The objects of the region of a particle. Call after one of the above.
  void list_particles(std::uint32_t particle, std::vector<IndexRange>& out);

 private:
  static constexpr std::uint32_t none = ~std::uint32_t{0};
  std::uint32_t root_of(std::uint32_t particle) { return connected_.root(object_of_[particle]); }
  void find(std::span<Projector* const> projectors, const ParticleView& particles);
  void sort_into_classes(std::span<Projector* const> projectors, const Substep& substep);
  std::uint32_t class_with(std::span<const int> sweeps);
  void list_runs(std::span<Projector* const> projectors, const ParticleView& particles);
  template <class RunsOf>
  void list(const Projector& projector, const ParticleView& particles, const RunsOf& runs_of) const;
  void list_ranges(const Projector& projector, const LinearFacet& set, std::size_t of_class,
                   std::vector<SweptRun>& runs);

  bool found_ = false;
  std::vector<IndexRange> objects_;       // their particles
  std::vector<std::uint32_t> object_of_;  // per particle
  std::vector<ObjectPair> joined_;
  DisjointSets connected_;                      // objects
  std::vector<std::uint32_t> by_region_;        // objects, region after region
  std::vector<std::uint32_t> class_of_;         // per object
  std::vector<std::uint8_t> chosen_;            // per root of a region
  std::vector<IndexRange> own_, found_ranges_;  // work space
  std::vector<int> sweeps_;                     // work space
  std::vector<SweepClass> classes_;
  std::vector<std::vector<IndexRange>> listed_;  // per class: the particles that the runs of sets are of
  std::size_t class_count_ = 0;
};

}  // namespace souple
