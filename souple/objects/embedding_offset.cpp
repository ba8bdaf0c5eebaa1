#include "souple/objects/embedding_offset.h"

#include "souple/geometry/closest_point.h"
#include "souple/geometry/measures.h"

#include <cmath>
#include <map>

namespace souple {
namespace {

using Cell = std::array<long long, 3>;

Cell cell_of(const Vec3d& x, double size) {
  return {static_cast<long long>(std::floor(x.x / size)), static_cast<long long>(std::floor(x.y / size)),
          static_cast<long long>(std::floor(x.z / size))};
}

/// The nearest point of the surface so far: its distance, and the dot product with its normal (positive
/// outside).
struct Foot {
  double distance, side = 0;
};

}  // namespace

std::vector<float> distances_outside(const std::vector<Vec3d>& points, const TriangleMesh& surface,
                                     double max_distance) {
  std::map<Cell, std::vector<std::size_t>> grid;
  for (std::size_t i = 0; i < points.size(); ++i) grid[cell_of(points[i], max_distance)].push_back(i);
  const std::vector<Vec3d> normals = vertex_normals(surface);
  std::vector<Foot> feet(points.size(), {max_distance});

  for (const Triangle& t : surface.triangles) {
    const Vec3d &a = surface.positions[t[0]], &b = surface.positions[t[1]], &c = surface.positions[t[2]];
    const BoundingBox box = bounding_box(std::vector<Vec3d>{a, b, c});
    const Vec3d margin{max_distance, max_distance, max_distance};
    const Cell lo = cell_of(box.lo - margin, max_distance), hi = cell_of(box.hi + margin, max_distance);
    for (long long x = lo[0]; x <= hi[0]; ++x)
      for (long long y = lo[1]; y <= hi[1]; ++y)
        for (auto cell = grid.lower_bound({x, y, lo[2]});
             cell != grid.end() && cell->first <= Cell{x, y, hi[2]}; ++cell)
          for (const std::size_t i : cell->second) {
            const TrianglePoint w = closest_on_triangle(points[i], a, b, c);
            const Vec3d away = points[i] - (a * w.a + b * w.b + c * w.c);
            const double distance = length(away);
            if (distance >= feet[i].distance) continue;
            // The normal blended from the vertices' normals classifies the side at edges and corners as well.
            feet[i] = {distance, dot(away, normals[t[0]] * w.a + normals[t[1]] * w.b + normals[t[2]] * w.c)};
          }
  }
  std::vector<float> result;
  result.reserve(feet.size());
  for (const Foot& foot : feet) result.push_back(foot.side > 0 ? static_cast<float>(foot.distance) : 0.0f);
  return result;
}

}  // namespace souple
