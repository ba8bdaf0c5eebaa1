#include "souple/mesh_files/tet_builder.h"

#include <algorithm>
#include <cmath>

namespace souple::mesh_detail {

bool TagIndex::finish(std::int64_t& duplicate) {
  std::sort(entries_.begin(), entries_.end());
  const auto same_tag = [](const auto& a, const auto& b) { return a.first == b.first; };
  const auto twice = std::adjacent_find(entries_.begin(), entries_.end(), same_tag);
  if (twice != entries_.end()) {
    duplicate = twice->first;
    return false;
  }
  // Without duplicates, a range as long as the list has no holes. (Unsigned: the range of 64-bit tags may
  // overflow.)
  consecutive_ =
      !entries_.empty() &&
      std::uint64_t(entries_.back().first) - std::uint64_t(entries_[0].first) == entries_.size() - 1;
  return true;
}

std::uint32_t TagIndex::find(std::int64_t tag) const {
  if (entries_.empty() || tag < entries_[0].first || tag > entries_.back().first) return none;
  if (consecutive_)
    return entries_[std::size_t(std::uint64_t(tag) - std::uint64_t(entries_[0].first))].second;
  const auto found = std::lower_bound(entries_.begin(), entries_.end(), std::pair(tag, std::uint32_t(0)));
  return found->first == tag ? found->second : none;
}

bool append_oriented(TetMesh& mesh, Tet tet) {
  const Vec3d a = mesh.positions[tet[0]];
  const Vec3d edges[3] = {mesh.positions[tet[1]] - a, mesh.positions[tet[2]] - a, mesh.positions[tet[3]] - a};
  double longest = 0.0;
  for (const Vec3d& edge : edges) {
    longest = std::max({longest, std::abs(edge.x), std::abs(edge.y), std::abs(edge.z)});
  }
  if (!(longest > 0.0)) return false;
  // Six times the volume of the tet scaled to unit size, which neither overflows nor underflows.
  const double s = 1.0 / longest;
  if (!std::isfinite(s)) return false;
  const double six_volumes = dot(cross(edges[0] * s, edges[1] * s), edges[2] * s);
  constexpr double flat = 1e-12;  // some thousand rounding errors
  if (!(std::abs(six_volumes) > flat)) return false;
  if (six_volumes < 0.0) std::swap(tet[2], tet[3]);
  mesh.tets.push_back(tet);
  return true;
}

}  // namespace souple::mesh_detail
