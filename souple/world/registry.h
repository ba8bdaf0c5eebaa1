#pragma once

#include "souple/world/name_registry.h"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>
#include <unordered_map>

namespace souple {

/// Where the record of a handle stands in a list, in constant time. A world never reuses a handle, so it needs no
/// generation: that of a removed record is found no more.
class HandleIndex {
 public:
  /// Adds the record that was appended to the list.
  void add(std::uint32_t handle) {
    const auto index = static_cast<std::uint32_t>(index_of_.size());
    index_of_.emplace(handle, index);
  }
  /// Removes the record that was erased; records behind it have moved forward. O(n), like erasing.
  void remove(std::uint32_t handle) {
    const auto removed = index_of_.find(handle);
    if (removed == index_of_.end()) return;
    const std::uint32_t index = removed->second;
    index_of_.erase(removed);
    for (auto& [other, at] : index_of_)
      if (at > index) --at;
  }
  std::optional<std::size_t> find(std::uint32_t handle) const {
    const auto found = index_of_.find(handle);
    return found != index_of_.end() ? std::optional<std::size_t>(found->second) : std::nullopt;
  }

 private:
  std::unordered_map<std::uint32_t, std::uint32_t> index_of_;
};

/// Handles and names of a world.
struct Registry {
  HandleIndex objects, colliders, joints, ties;
  NameRegistry names;        ///< of objects and colliders
  NameRegistry joint_names;  ///< a joint may have the name of an object
  std::uint32_t next_id = 1;
};

/// Throws Error: there is no `what`, such as a joint, with the handle.
[[noreturn]] void throw_stale(std::string_view what, std::uint32_t handle);

}  // namespace souple
