#include "souple/geometry/convex_hull.h"

#include "souple/error.h"
#include "souple/geometry/hull_faces.h"
#include "souple/geometry/measures.h"
#include "souple/geometry/quickhull.h"
#include "souple/math/limits.h"
#include "souple/math/sentinels.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/core.h>

namespace souple {
namespace {

void check_options(const HullOptions& options, const std::string& name) {
  if (!(options.tolerance >= 0 && options.tolerance <= 0.1))
    throw Error(fmt::format("{}: the tolerance is {:g}, expected a fraction of the size from 0 to 0.1", name,
                            options.tolerance));
  if (options.max_vertices != 0 && options.max_vertices < 4)
    throw Error(fmt::format("{}: max_vertices is {}, expected at least 4, or 0 for no limit", name,
                            options.max_vertices));
}

void check_points(std::span<const Vec3d> points, const std::string& name) {
  if (points.size() < 4)
    throw Error(fmt::format("{}: there are {} points, expected at least 4 that are not in one plane", name,
                            points.size()));
  if (points.size() >= no_index)
    throw Error(fmt::format("{}: {} points are too many, expected fewer than 2^32", name, points.size()));
  for (std::size_t i = 0; i < points.size(); ++i)
    if (!is_within(points[i], range::coordinate))
      throw Error(
          fmt::format("{}: point {} is at {:g}, {:g}, {:g}, expected finite coordinates of at most 1e9 m",
                      name, i, points[i].x, points[i].y, points[i].z));
}

[[noreturn]] void throw_degenerate(std::size_t dimension_count, double thickness, const std::string& name) {
  constexpr const char* where[] = {"", "coincide", "lie on a line", "lie in a plane"};
  throw Error(fmt::format(
      "{}: all points {} (within {:.3g} m), so they enclose no volume; give the shape a thickness, or "
      "use a smaller tolerance",
      name, where[dimension_count], thickness));
}

// The points rounded to a grid of 2^grid_bits steps. The step is a power of two, so that nothing else is rounded.
class Grid {
 public:
  explicit Grid(const BoundingBox& bounds) : origin_(bounds.lo) {
    const Vec3d size = bounds.size();
    int exponent = 0;
    std::frexp(std::max({size.x, size.y, size.z, std::numeric_limits<double>::min()}), &exponent);
    step_ = std::ldexp(1.0, std::max(exponent - grid_bits, std::numeric_limits<double>::min_exponent));
  }
  double step() const { return step_; }
  GridPoint round(const Vec3d& p) const {
    const Vec3d steps = (p - origin_) / step_;
    return {std::llround(steps.x), std::llround(steps.y), std::llround(steps.z)};
  }
  /// Relative to the low corner of the box [m].
  Vec3d local(const GridPoint& p) const { return Vec3d(p) * step_; }

 private:
  Vec3d origin_;
  double step_{};
};

struct LocalHull {
  std::size_t
      corners{};  // 4, or fewer for points in a plane, on a line or at one place; then there is no more
  std::vector<Vec3d> positions;  // of all points
  HullTriangles triangles;
  HullPolygons polygons;
  double tolerance{};  // m
};

// Only vertices matter from here on; the others keep their numbers.
LocalHull hull_on_grid(std::span<const Vec3d> points, const HullOptions& options) {
  const BoundingBox bounds = bounding_box(points);
  const Grid grid(bounds);
  std::vector<GridPoint> rounded;
  rounded.reserve(points.size());
  LocalHull hull;
  hull.positions.reserve(points.size());
  for (const Vec3d& p : points) {
    rounded.push_back(grid.round(p));
    hull.positions.push_back(grid.local(rounded.back()));
  }
  hull.tolerance = std::max(grid.step(), options.tolerance * bounds.diagonal());
  const double steps = hull.tolerance / grid.step();
  const Simplex simplex = find_simplex(rounded, steps);
  hull.corners = simplex.count;
  if (hull.corners < 4) return hull;
  const std::size_t limit =
      options.max_vertices == 0 ? std::numeric_limits<std::size_t>::max() : options.max_vertices;
  hull.triangles = quickhull(rounded, simplex, steps, limit);
  hull.polygons = merge_coplanar(hull.positions, hull.triangles, hull.tolerance);
  return hull;
}

// How far the points outside lie beyond the planes of faces at most. The triangles that a point sees are connected; their
// faces and those beside them are compared.
double measure_excess(const LocalHull& hull) {
  const HullTriangles& t = hull.triangles;
  std::vector<std::uint32_t> reached(t.triangles.size(), no_index), queue;
  double excess = 0;
  for (const auto& [point, triangle] : t.outside) {
    const Vec3d& p = hull.positions[point];
    queue.assign(1, triangle);
    reached[triangle] = point;
    for (std::size_t i = 0; i < queue.size(); ++i) {
      const HullPolygon& polygon = hull.polygons.polygons[hull.polygons.of_triangle[queue[i]]];
      excess = std::max(excess, dot(polygon.normal, p) - polygon.offset);
      if (i > 0 && dot(t.normals[queue[i]], p - hull.positions[t.triangles[queue[i]][0]]) <= 0) continue;
      for (const std::uint32_t other : t.neighbors[queue[i]])
        if (reached[other] != point) {
          reached[other] = point;
          queue.push_back(other);
        }
    }
  }
  return excess;
}

// The points that are corners become vertices, in their order. Returns the vertex of each point.
std::vector<std::uint32_t> add_vertices(ConvexHull& out, std::span<const Vec3d> points,
                                        std::span<const HullPolygon> polygons) {
  std::vector<std::uint32_t> vertex_of(points.size(), no_index);
  for (const HullPolygon& p : polygons)
    for (const std::uint32_t v : p.corners) vertex_of[v] = 0;
  for (std::uint32_t i = 0; i < points.size(); ++i) {
    if (vertex_of[i] == no_index) continue;
    vertex_of[i] = static_cast<std::uint32_t>(out.positions.size());
    out.positions.push_back(points[i]);
    out.source.push_back(i);
  }
  return vertex_of;
}

ConvexHull hull_of(std::span<const Vec3d> points, const LocalHull& hull) {
  const std::vector<HullPolygon>& polygons = hull.polygons.polygons;

  ConvexHull out;
  const std::vector<std::uint32_t> vertex_of = add_vertices(out, points, polygons);
  const Vec3d origin = bounding_box(points).lo;
  for (const HullPolygon& p : polygons) {
    out.faces.push_back({p.normal, p.offset + dot(p.normal, origin),
                         static_cast<std::uint32_t>(out.corners.size()),
                         static_cast<std::uint32_t>(p.corners.size())});
    for (const std::uint32_t v : p.corners) out.corners.push_back(vertex_of[v]);
  }
  out.excess = measure_excess(hull);
  return out;
}

}  // namespace

ConvexHull convex_hull(std::span<const Vec3d> points, const HullOptions& options, const std::string& name) {
  check_options(options, name);
  check_points(points, name);
  const LocalHull hull = hull_on_grid(points, options);
  if (hull.corners < 4) throw_degenerate(hull.corners, hull.tolerance, name);
  return hull_of(points, hull);
}

std::optional<ConvexHull> solid_convex_hull(std::span<const Vec3d> points, const HullOptions& options,
                                            const std::string& name) {
  check_options(options, name);
  if (points.size() < 4) return {};
  check_points(points, name);
  const LocalHull hull = hull_on_grid(points, options);
  if (hull.corners < 4) return {};
  return hull_of(points, hull);
}

TriangleMesh surface_mesh(const ConvexHull& hull) {
  TriangleMesh mesh;
  mesh.positions = hull.positions;
  for (const HullFace& face : hull.faces) {
    const std::span<const std::uint32_t> loop = hull.loop(face);
    mesh.faces.emplace_back(loop.begin(), loop.end());
    for (std::size_t i = 1; i + 1 < loop.size(); ++i)
      mesh.triangles.push_back({loop[0], loop[i], loop[i + 1]});
  }
  if (mesh.faces.size() == mesh.triangles.size()) mesh.faces.clear();
  return mesh;
}

}  // namespace souple
