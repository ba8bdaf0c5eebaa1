#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

namespace souple::mesh_detail {

/// Limit of the groups in a `g` line of OBJ. All following faces belong to each of them: without a limit, a
/// short file could demand any amount of memory.
constexpr std::size_t most_groups_at_once = 16;

/// Collects the vertices of named groups, in any order and with repetitions.
class GroupBuilder {
 public:
  /// The list for a group's vertices; its address is stable when groups are added.
  std::vector<std::uint32_t>& operator[](const std::string& name) { return groups_[name]; }

  /// The groups in ascending order without repetitions; empty groups are omitted.
  std::map<std::string, std::vector<std::uint32_t>> finish() {
    for (auto group = groups_.begin(); group != groups_.end();) {
      sort_unique(group->second);
      group = group->second.empty() ? groups_.erase(group) : std::next(group);
    }
    return std::move(groups_);
  }

  static void sort_unique(std::vector<std::uint32_t>& list) {
    std::sort(list.begin(), list.end());
    list.erase(std::unique(list.begin(), list.end()), list.end());
  }

 private:
  std::map<std::string, std::vector<std::uint32_t>> groups_;
};

}  // namespace souple::mesh_detail
