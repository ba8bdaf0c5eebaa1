#include "render/wall.h"

#include "souple/geometry/weld.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

namespace souple::render {

namespace {

using Edge = std::pair<std::uint32_t, std::uint32_t>;

/// Whether each directed edge occurs once, and its reverse too.
bool is_closed(std::span<const Triangle> triangles) {
  std::vector<Edge> forward, backward;
  for (const Triangle& t : triangles)
    for (std::size_t k = 0; k < 3; ++k) {
      forward.emplace_back(t[k], t[(k + 1) % 3]);
      backward.emplace_back(t[(k + 1) % 3], t[k]);
    }
  std::sort(forward.begin(), forward.end());
  std::sort(backward.begin(), backward.end());
  return !forward.empty() && forward == backward;
}

}  // namespace

Wall wall_of(std::span<const Vec3f> positions, std::span<const Triangle> triangles) {
  const bool finite =
      std::all_of(positions.begin(), positions.end(), [](const Vec3f& x) { return is_finite(x); });
  if (!finite) return {};
  // Creased surfaces repeat vertices at equal positions.
  const Weld weld = weld_vertices(std::vector<Vec3d>(positions.begin(), positions.end()));
  std::vector<Triangle> joined(triangles.begin(), triangles.end());
  double volume = 0, area = 0;
  for (Triangle& t : joined) {
    if (std::max({t[0], t[1], t[2]}) >= positions.size()) return {};
    const Vec3d a(positions[t[0]]), b(positions[t[1]]), c(positions[t[2]]);
    volume += dot(a, cross(b, c)) / 6;
    area += length(cross(b - a, c - a)) / 2;
    for (std::uint32_t& vertex : t) vertex = weld.to_welded[vertex];
  }
  const double thickness = 2 * volume / area;
  if (!(thickness > 0) || !is_closed(joined)) return {};
  return {true, static_cast<float>(thickness)};
}

}  // namespace souple::render
