#pragma once

#include "souple/world/name_registry.h"
#include "souple/world/removal.h"

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
  /// Takes back the last record.
  void remove_last(std::uint32_t handle) { index_of_.erase(handle); }
  /// Call after records were erased: record k of those that remain has the handle handle_of(k). O(n), like erasing.
  template <class HandleOf>
  void reset(std::size_t count, const HandleOf& handle_of) {
    index_of_.clear();
    for (std::size_t k = 0; k < count; ++k) add(handle_of(k));
  }
  std::optional<std::size_t> find(std::uint32_t handle) const {
    const auto found = index_of_.find(handle);
    return found != index_of_.end() ? std::optional<std::size_t>(found->second) : std::nullopt;
  }

 private:
  std::unordered_map<std::uint32_t, std::uint32_t> index_of_;
};

/// Handles and names of a world, also of objects whose removal is pending.
struct Registry {
  HandleIndex objects, colliders, joints, ties;
  NameRegistry names;        ///< of objects and colliders
  NameRegistry joint_names;  ///< a joint may have the name of an object
  std::uint32_t next_id = 1;
  Removals removals;
};

/// Throws Error: there is no `what`, such as a joint, with the handle.
[[noreturn]] void throw_stale(std::string_view what, std::uint32_t handle);

}  // namespace souple
