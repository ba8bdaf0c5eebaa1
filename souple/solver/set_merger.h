#pragma once

#include "souple/constraints/constraint_set.h"
#include "souple/math/lists.h"
#include "souple/solver/coloring.h"

#include <algorithm>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

namespace souple {

/// The constraints of one object in a set that holds those of many, see SetProjector::merge.
struct ObjectPart {
  std::uint32_t begin = 0, end = 0;  ///< its particles when the set was last merged; equal: it had none
  std::uint32_t new_begin = 0;       ///< its first particle from now on
};

/// Replaces the constraints of single objects in a set of many, see SetProjector::merge. `fresh`, per part: the object's new
/// constraints, with particles numbered from 0; null: it keeps those it has.
template <class Kind>
class SetMerger {
 public:
  using Set = ConstraintSet<Kind>;

  SetMerger(const Set& old, std::span<const ObjectPart> parts)
      : old_(old), parts_(parts), colors_(old.color_count()), runs_(parts.size() * colors_) {
    find_runs();
  }

  /// Colors the fresh constraints, those that link the same particles as before as they were. Returns whether all do, so
  /// that only values changed.
  bool color_as_before(std::span<Set* const> fresh) const {
    bool values_only = !old_.color_begin.empty();
    std::size_t found = 0;
    for (std::size_t p = 0; p < parts_.size(); ++p) {
      std::size_t size = 0;
      for (const Run& run : runs_of(p)) size += run.end - run.begin;
      found += size;
      if (size > 0 && parts_[p].begin != parts_[p].new_begin) values_only = false;
      if (fresh[p] != nullptr) values_only = color_as(*fresh[p], p, size) && values_only;
    }
    return values_only && found == old_.size();
  }

  /// For each color the constraints of each part: fresh ones, or those in its run.
  Set join(std::span<Set* const> fresh) const {
    std::size_t most_colors = colors_;
    for (const Set* const own : fresh)
      if (own != nullptr) most_colors = std::max(most_colors, own->color_count());
    Set joined;
    for (std::size_t c = 0; c < most_colors; ++c) {
      const std::size_t color_begin = joined.size();
      for (std::size_t p = 0; p < parts_.size(); ++p) {
        const Set* const own = fresh[p];
        if (own != nullptr && c < own->color_count()) {
          joined.append(*own, own->color_begin[c], own->color_begin[c + 1], parts_[p].new_begin);
        } else if (own == nullptr && c < colors_) {
          const Run& run = runs_of(p)[c];
          joined.append(old_, run.begin, run.end, parts_[p].new_begin - parts_[p].begin);
        }
      }
      if (joined.size() > color_begin) joined.color_begin.push_back(static_cast<std::uint32_t>(color_begin));
    }
    joined.color_begin.push_back(static_cast<std::uint32_t>(joined.size()));
    joined.shrink_to_fit();
    return joined;
  }

 private:
  /// Constraints [begin, end) of the old set: of one object and color.
  struct Run {
    std::size_t begin = 0, end = 0;
  };

  std::span<const Run> runs_of(std::size_t part) const {
    return std::span(runs_).subspan(part * colors_, colors_);
  }
  // Within a color, constraints are sorted by their lowest particle, so by object.
  void find_runs() {
    for (std::size_t c = 0; c < colors_; ++c) {
      std::size_t i = old_.color_begin[c];
      const auto reach = [&](std::uint32_t particle) {
        while (i < old_.color_begin[c + 1] && old_.records[0][i] / 4 < particle) ++i;
        return i;
      };
      for (std::size_t p = 0; p < parts_.size(); ++p) {
        Run& run = runs_[p * colors_ + c];
        run.begin = reach(parts_[p].begin);
        run.end = reach(std::max(parts_[p].begin, parts_[p].end));
      }
    }
  }

  // The order in which these constraints of one object are those of its runs. It is empty if they differ. Two on the same
  // particles count as different, because their order would be a guess. The order of addition needs no comparison: it
  // follows from the object's mesh.
  std::vector<std::uint32_t> order_as(const Set& fresh, std::size_t part, std::size_t particle_count) const {
    const Lists<std::uint32_t> by_first(particle_count, [&](const auto& add) {
      for (std::uint32_t i = 0; i < fresh.size(); ++i) add(fresh.records[0][i] / 4, i);
    });
    const std::uint32_t begin = parts_[part].begin;
    const auto same = [&](std::uint32_t e, std::size_t i) {
      for (std::size_t k = 1; k < Set::arity; ++k)
        if (fresh.records[k][e] + 4 * begin != old_.records[k][i]) return false;
      return true;
    };
    std::vector<std::uint32_t> order;
    std::vector<bool> taken(fresh.size());
    for (const Run& run : runs_of(part))
      for (std::size_t i = run.begin; i < run.end; ++i) {
        const std::size_t first = old_.records[0][i] / 4 - begin;
        if (first >= particle_count) return {};
        std::size_t count = 0;
        for (const std::uint32_t e : by_first[first])
          if (same(e, i)) order.push_back(e), ++count;
        if (count != 1 || taken[order.back()]) return {};
        taken[order.back()] = true;
      }
    return order;
  }

  // Colors constraints that were only added: as those in the part's runs, `size` of them, if they link the same particles.
  // Returns whether they do.
  bool color_as(Set& fresh, std::size_t part, std::size_t size) const {
    if (fresh.size() == 0) {
      fresh.color_begin = {0};
      return size == 0;
    }
    const std::vector<std::uint32_t> flat = fresh.flat_indices();
    const std::size_t particle_count = *std::max_element(flat.begin(), flat.end()) + std::size_t{1};
    Coloring coloring;
    if (size == fresh.size()) coloring.order = order_as(fresh, part, particle_count);
    const bool same = !coloring.order.empty();
    if (same) {
      std::size_t color_begin = 0;
      for (const Run& run : runs_of(part)) {
        if (run.begin < run.end) coloring.color_begin.push_back(static_cast<std::uint32_t>(color_begin));
        color_begin += run.end - run.begin;
      }
      coloring.color_begin.push_back(static_cast<std::uint32_t>(size));
    } else {
      coloring = color_constraints(flat, Kind::arity, particle_count);
    }
    fresh.reorder(coloring.order);
    fresh.color_begin = std::move(coloring.color_begin);
    return same;
  }

  const Set& old_;
  std::span<const ObjectPart> parts_;
  std::size_t colors_;
  std::vector<Run> runs_;  // per part and color
};

}  // namespace souple
