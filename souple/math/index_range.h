#pragma once

#include <algorithm>
#include <cstddef>
#include <span>
#include <vector>

namespace souple {

/// Indices [begin, end).
struct IndexRange {
  std::size_t begin = 0, end = 0;
};

/// The indices below `count` of which `holds` is true.
template <class Predicate>
std::vector<IndexRange> ranges_where(std::size_t count, const Predicate& holds) {
  std::vector<IndexRange> ranges;
  for (std::size_t i = 0; i < count; ++i) {
    if (!holds(i)) continue;
    if (!ranges.empty() && ranges.back().end == i)
      ++ranges.back().end;
    else
      ranges.push_back({i, i + 1});
  }
  return ranges;
}

/// Removes the items of ranges, ascending. O(n), however many there are.
template <class Item>
void erase_ranges(std::vector<Item>& items, std::span<const IndexRange> ranges) {
  if (ranges.empty()) return;
  const auto at = [&](std::size_t index) { return items.begin() + static_cast<std::ptrdiff_t>(index); };
  auto to = at(ranges[0].begin);
  for (std::size_t k = 0; k < ranges.size(); ++k)
    to = std::move(at(ranges[k].end), k + 1 < ranges.size() ? at(ranges[k + 1].begin) : items.end(), to);
  items.erase(to, items.end());
}

}  // namespace souple
