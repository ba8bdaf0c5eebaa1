#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

namespace souple::mesh_detail {

/// A `g` line of OBJ may name many groups at once, and every face below goes into each: without a limit, a
/// short file could ask for any amount of memory.
constexpr std::size_t most_groups_at_once = 16;

/// Gathers the vertices of named groups, in any order and any number of times each.
class GroupBuilder {
 public:
  /// The list to append a group's vertices to; stays where it is when others are added.
  std::vector<std::uint32_t>& operator[](const std::string& name) { return groups_[name]; }

  /// Each group ascending, each vertex once; groups without vertices are left out.
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
