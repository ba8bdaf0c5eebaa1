#pragma once

#include "souple/geometry/tet_mesh.h"
#include "souple/io/mesh_groups.h"
#include "souple/io/mesh_text.h"

#include <cstddef>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

namespace souple::mesh_detail {

/// From the names (tags, numbers) that a file gives its nodes to their places in its list.
class TagIndex {
 public:
  static constexpr std::uint32_t none = ~std::uint32_t(0);

  void reserve(std::size_t count) { entries_.reserve(count); }
  void add(std::int64_t tag) { entries_.emplace_back(tag, std::uint32_t(entries_.size())); }
  std::size_t size() const { return entries_.size(); }

  /// To be called once, behind the last add. False where a tag came twice, which `duplicate` then holds.
  bool finish(std::int64_t& duplicate);
  /// The place of a tag, or none.
  std::uint32_t find(std::int64_t tag) const;

 private:
  std::vector<std::pair<std::int64_t, std::uint32_t>> entries_;
  bool consecutive_ = false;  // then no search is needed
};

/// Appends a tet, turned to be positively oriented if need be. False where it is flat (or uses a vertex
/// twice).
bool append_oriented(TetMesh& mesh, Tet tet);

}  // namespace souple::mesh_detail
