#pragma once

#include "souple/broad_phase/near_pairs.h"
#include "souple/contacts/surfaces/element_surfaces.h"
#include "souple/contacts/surfaces/predicted_paths.h"
#include "souple/contacts/surfaces/surface_groups.h"
#include "souple/threads/threads.h"

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace souple {

struct PairSearchInput {
  const ElementSurfaces& surfaces;
  const PredictedPaths& paths;
  std::span<const Vec4f> position;  ///< per particle; w: inverse mass [1/kg]
  Threads& threads;
};

/// Searches for near pairs of elements within surfaces and between them. A group of surfaces has a budget in proportion to
/// its elements. The pairs of a group that exceeds it are left out.
class PairSearch {
 public:
  using Input = PairSearchInput;
  PairSearch() = default;
  explicit PairSearch(const ElementSurfaces& surfaces);

  SurfaceGroups& groups() { return groups_; }
  const SurfaceGroups& groups() const { return groups_; }
  bool is_searched(const ElementSurfaces& surfaces, std::uint32_t surface) const {
    return surfaces[surface].self_collision || groups_.overlaps_other(surface);
  }
  /// Greatest number of pairs within the surfaces of a group, and between them.
  std::size_t budget(const ElementSurfaces& surfaces, std::size_t group) const;
  /// That of a surface, if it were alone.
  std::size_t budget(std::uint32_t surface) const {
    return pairs_of_any + pairs_of_element * elements_[surface];
  }

  /// Searches for all pairs.
  void find_all(const Input& input);
  /// Whether a surface overlaps others, but did not when elements were last chosen.
  bool is_new(std::uint32_t surface) const {
    return groups_.overlaps_other(surface) && has_elements_[surface] == 0;
  }
  /// Searches for the pairs of `moved` alone, ascending, after their boxes changed.
  void find_moved(const Input& input, std::span<const std::uint32_t> moved);
  /// Groups that exceeded their budget in that search, ascending.
  std::span<const std::uint32_t> over() const { return over_; }
  /// Searches for all pairs of one group alone. Returns false if there are more than `most`.
  bool find_group(const Input& input, std::size_t group, std::size_t most);

  const NearPairs& within() const { return within_; }
  const NearPairs& between() const { return between_; }
  /// Pairs of the last search whose first particle is one of the surface.
  std::size_t found(std::uint32_t surface) const { return found_[surface][0] + found_[surface][1]; }
  std::size_t bytes() const;

 private:
  // A sheet that collapses in folds has 25 pairs for each element. The others are for any scene.
  static constexpr std::size_t pairs_of_element = 32, pairs_of_any = 65536;

  void choose_elements(const Input& input);
  std::size_t budget_of_chosen(const Input& input) const;
  bool find(const Input& input, std::span<const std::uint32_t> moved, std::size_t most);
  template <class Predicate>
  bool find_of(const Input& input, std::span<const std::uint32_t> moved, std::size_t most,
               const Predicate& is_in);
  bool exceeds_budget(const Input& input, std::size_t group) const;
  void find_over(const Input& input, std::span<const std::uint32_t> moved, bool complete);
  void count(const Input& input);
  void drop_over(const Input& input, NearPairs& pairs) const;

  SurfaceGroups groups_;
  std::vector<std::size_t> elements_;       // per surface: vertices and edges
  std::vector<std::uint8_t> has_elements_;  // per surface: of between_elements_
  SurfaceElements within_elements_;         // of surfaces with self-collision
  SurfaceElements between_elements_;        // of surfaces that overlap others
  NearPairFinder within_finder_, between_finder_;
  NearPairs within_, between_;
  std::vector<std::array<std::size_t, 2>> found_;  // per surface: within, between
  std::vector<std::uint32_t> over_;
  std::vector<std::uint8_t> is_over_, chosen_;  // per group
  std::vector<std::uint32_t> moved_in_;         // work space
};

}  // namespace souple
