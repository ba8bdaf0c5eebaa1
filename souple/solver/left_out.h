#pragma once

#include "souple/assert.h"
#include "souple/solver/projector.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

namespace souple {

class Projector;

/// Constraints that sweeps leave out because the solver solves them otherwise, or because they move nothing.
class LeftOut {
 public:
  void clear() { sets_.clear(); }
  bool empty() const { return sets_.empty(); }
  /// `constraints` of a projector of `size` constraints, each once, in any order.
  void add(const Projector& projector, std::vector<std::uint32_t> constraints, std::size_t size) {
    std::sort(constraints.begin(), constraints.end());
    SOUPLE_ASSERT(std::adjacent_find(constraints.begin(), constraints.end()) == constraints.end(),
                  "each constraint is left out once");
    SOUPLE_ASSERT(constraints.empty() || constraints.back() < size, "constraints of the projector");
    Set set{&projector, {}};
    std::size_t begin = 0;
    for (const std::uint32_t constraint : constraints) {
      if (constraint > begin) set.kept.push_back({begin, constraint});
      begin = constraint + std::size_t{1};
    }
    if (size > begin) set.kept.push_back({begin, size});
    sets_.push_back(std::move(set));
  }
  /// The constraints of some ranges of a projector of `size`, ascending and disjoint.
  void add_ranges(const Projector& projector, std::span<const IndexRange> ranges, std::size_t size) {
    Set set{&projector, {}};
    std::size_t begin = 0;
    for (const IndexRange& range : ranges) {
      SOUPLE_ASSERT(begin <= range.begin && range.begin <= range.end && range.end <= size,
                    "ranges of the projector's constraints, ascending");
      if (range.begin > begin) set.kept.push_back({begin, range.begin});
      begin = range.end;
    }
    if (size > begin) set.kept.push_back({begin, size});
    sets_.push_back(std::move(set));
  }
  /// Calls f(begin, end) for the ranges of [begin, end) that remain.
  template <class Function>
  void for_each_kept(const Projector& projector, std::size_t begin, std::size_t end,
                     const Function& f) const {
    const auto set =
        std::find_if(sets_.begin(), sets_.end(), [&](const Set& s) { return s.projector == &projector; });
    if (set == sets_.end()) return f(begin, end);
    auto range = std::upper_bound(set->kept.begin(), set->kept.end(), begin,
                                  [](std::size_t i, const IndexRange& r) { return i < r.end; });
    for (; range != set->kept.end() && range->begin < end; ++range)
      f(std::max(begin, range->begin), std::min(end, range->end));
  }

 private:
  struct Set {
    const Projector* projector;
    std::vector<IndexRange> kept;
  };
  std::vector<Set> sets_;
};

}  // namespace souple
