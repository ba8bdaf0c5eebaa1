#include "souple/contacts/surfaces/surface_groups.h"

#include "souple/state/bytes.h"

namespace souple {

void SurfaceGroups::set_count(std::size_t surfaces) {
  bounds_.assign(surfaces, empty_bounds);
  overlaps_other_.assign(surfaces, 0);
  group_.resize(surfaces);
}

void SurfaceGroups::find(const ElementSurfaces& surfaces) {
  const auto n = static_cast<std::uint32_t>(bounds_.size());
  sets_.reset(n);
  overlaps_other_.assign(n, 0);
  for (const auto& [a, b] : sweep_.find(bounds_)) {
    if (!surfaces.collides_with_other(a, b)) continue;
    overlaps_other_[a] = overlaps_other_[b] = 1;
    sets_.join(a, b);
  }
  // A root is the lowest of its set, so its group is known before those of the others.
  std::uint32_t count = 0;
  for (std::uint32_t a = 0; a < n; ++a) {
    const std::uint32_t root = sets_.root(a);
    group_[a] = root == a ? count++ : group_[root];
  }
  members_.fill(count, [&](const auto& add) {
    for (std::uint32_t a = 0; a < n; ++a) add(group_[a], a);
  });
}

std::size_t SurfaceGroups::bytes() const {
  return bytes_of(bounds_, overlaps_other_, group_) + members_.bytes() + sets_.bytes() + sweep_.bytes();
}

}  // namespace souple
