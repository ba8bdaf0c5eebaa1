#pragma once

#include "souple/broad_phase/bounds.h"
#include "souple/broad_phase/object_pairs.h"
#include "souple/contacts/surfaces/element_surfaces.h"
#include "souple/math/disjoint_sets.h"
#include "souple/math/lists.h"

#include <cstdint>
#include <span>
#include <vector>

namespace souple {

/// Groups of surfaces whose bounds overlap, directly or through others. A search for pairs decides for each group: nothing
/// changes by surfaces that are elsewhere.
class SurfaceGroups {
 public:
  /// Bounds around what a surface may pass within the time that its search covers.
  void set_bounds(std::uint32_t surface, const Bounds& bounds) { bounds_[surface] = bounds; }
  void set_count(std::size_t surfaces);
  /// Finds the groups of the present bounds. Only surfaces that may collide with each other join.
  void find(const ElementSurfaces& surfaces);

  std::size_t size() const { return members_.size(); }
  /// The group of a surface: its place in order of the lowest surfaces.
  std::uint32_t of(std::uint32_t surface) const { return group_[surface]; }
  /// Surfaces of a group, ascending.
  std::span<const std::uint32_t> members(std::size_t group) const { return members_[group]; }
  bool overlaps_other(std::uint32_t surface) const { return overlaps_other_[surface] != 0; }
  /// Per surface: whether it overlaps another one.
  std::span<const std::uint8_t> overlaps_other() const { return overlaps_other_; }
  std::size_t bytes() const;

 private:
  std::vector<Bounds> bounds_;
  std::vector<std::uint8_t> overlaps_other_;
  std::vector<std::uint32_t> group_;
  Lists<std::uint32_t> members_;
  DisjointSets sets_;
  BoxSweep sweep_;
};

}  // namespace souple
