#include "souple/geometry/reorder.h"

#include "souple/assert.h"
#include "souple/geometry/measures.h"

#include <algorithm>

namespace souple {
namespace {

// Inserts two zeros before each of the low 21 bits.
std::uint64_t spread_bits(std::uint64_t x) {
  x &= 0x1fffff;
  x = (x | x << 32) & 0x1f00000000ffff;
  x = (x | x << 16) & 0x1f0000ff0000ff;
  x = (x | x << 8) & 0x100f00f00f00f00f;
  x = (x | x << 4) & 0x10c30c30c30c30c3;
  x = (x | x << 2) & 0x1249249249249249;
  return x;
}

}  // namespace

std::vector<std::uint32_t> morton_order(std::span<const Vec3d> positions) {
  const BoundingBox box = bounding_box(positions);
  struct Key {
    std::uint64_t code;
    std::uint32_t vertex;
    bool operator<(const Key& b) const { return code != b.code ? code < b.code : vertex < b.vertex; }
  };
  // One scale for all axes, so that cells of the curve are cubes. Half extents: the full extent of extreme
  // numbers overflows.
  double half_extent = 0;
  for (int i = 0; i < 3; ++i) half_extent = std::max(half_extent, box.hi[i] / 2 - box.lo[i] / 2);
  std::vector<Key> keys;
  keys.reserve(positions.size());
  for (std::uint32_t v = 0; v < positions.size(); ++v) {
    std::uint64_t code = ~std::uint64_t(0);
    if (is_finite(positions[v])) {
      code = 0;
      for (int i = 0; i < 3; ++i) {
        const double t = half_extent > 0 ? (positions[v][i] / 2 - box.lo[i] / 2) / half_extent : 0;
        code |= spread_bits(std::uint64_t(std::clamp(t, 0.0, 1.0) * 2097151.0)) << i;
      }
    }
    keys.push_back({code, v});
  }
  std::sort(keys.begin(), keys.end());
  std::vector<std::uint32_t> order;
  order.reserve(keys.size());
  for (const Key& key : keys) order.push_back(key.vertex);
  return order;
}

std::vector<std::uint32_t> inverse_order(std::span<const std::uint32_t> order) {
  std::vector<std::uint32_t> inverse(order.size());
  for (std::uint32_t k = 0; k < order.size(); ++k) {
    SOUPLE_ASSERT(order[k] < order.size() && inverse[order[k]] == 0, "the order is a permutation");
    inverse[order[k]] = k;
  }
  return inverse;
}

}  // namespace souple
