#pragma once

#include "souple/geometry/tet_mesh.h"
#include "souple/mesh_files/mesh_groups.h"
#include "souple/mesh_files/mesh_text.h"

#include <cstddef>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

namespace souple::mesh_detail {

/// Maps the tags that a file gives its nodes to their indices in its list.
class TagIndex {
 public:
  static constexpr std::uint32_t none = ~std::uint32_t(0);

  void reserve(std::size_t count) { entries_.reserve(count); }
  void add(std::int64_t tag) { entries_.emplace_back(tag, std::uint32_t(entries_.size())); }
  std::size_t size() const { return entries_.size(); }

  /// Call once, after the last add. Returns false if a tag occurs twice; `duplicate` then holds it.
  bool finish(std::int64_t& duplicate);
  /// The index of a tag, or none.
  std::uint32_t find(std::int64_t tag) const;

 private:
  std::vector<std::pair<std::int64_t, std::uint32_t>> entries_;
  bool consecutive_ = false;  // tags are consecutive: no search necessary
};

/// Appends a tet, reordered to positive orientation if necessary. Returns false if it is flat or uses a
/// vertex twice.
bool append_oriented(TetMesh& mesh, Tet tet);

}  // namespace souple::mesh_detail
