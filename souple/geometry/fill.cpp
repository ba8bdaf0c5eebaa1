#include "souple/geometry/fill.h"

#include "souple/error.h"
#include "souple/geometry/measures.h"
#include "souple/geometry/mesh_report.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/core.h>

namespace souple {

namespace {

constexpr double max_points = 2e7;

/// Points origin + (i, j, k) spacing for i < count[0] and so on.
struct Rows {
  Vec3d origin{};
  std::array<std::size_t, 3> count{};
  double spacing = 1;

  Vec3d at(std::size_t i, std::size_t j, std::size_t k) const {
    return origin + Vec3d{double(i), double(j), double(k)} * spacing;
  }
};

Rows rows_of(const Vec3d& lo, const Vec3d& hi, double spacing, const std::string& name) {
  if (!(spacing > 0) || !std::isfinite(spacing))
    throw Error(fmt::format("{}: the spacing is {:g} m, expected a positive number", name, spacing));
  if (!is_finite(lo) || !is_finite(hi)) throw Error(name + ": a coordinate is not finite");
  Rows rows;
  rows.spacing = spacing;
  double all = 1;
  for (int axis = 0; axis < 3; ++axis) {
    const double fits = std::floor((hi[axis] - lo[axis]) / spacing + 1e-4);
    if (!(fits >= 1))
      throw Error(fmt::format("{}: is {:g} m wide along {}, too small for a fluid with spacing {:g} m", name,
                              hi[axis] - lo[axis], "xyz"[axis], spacing));
    all *= fits;
    if (all > max_points)
      throw Error(
          fmt::format("{}: would take more than 20 million particles of spacing {:g} m; enlarge the spacing",
                      name, spacing));
    rows.count[std::size_t(axis)] = std::size_t(fits);
    rows.origin[axis] = 0.5 * (lo[axis] + hi[axis] - spacing * (fits - 1));
  }
  return rows;
}

/// A crossing of a row along x and a triangle, and the change of the winding number there.
struct Crossing {
  double x;
  int change;
};

/// Twice the signed area of (a, b, p) in the yz plane. It is the exact negative of (b, a, p), so a point on an edge
/// belongs to exactly one of its two triangles.
double side(const Vec3d& a, const Vec3d& b, double y, double z) {
  if (b.y < a.y || (b.y == a.y && b.z < a.z)) return -side(b, a, y, z);
  return (b.y - a.y) * (z - a.z) - (b.z - a.z) * (y - a.y);
}

/// Rows are shifted by an offset that meshes do not contain, so that no row passes through a vertex or along
/// an edge.
class Crossings {
 public:
  Crossings(const Rows& rows) : rows_(rows), of_row_(rows.count[1] * rows.count[2]) {}

  void add(const Vec3d& a, const Vec3d& b, const Vec3d& c) {
    const auto [j0, j1] = range(1, std::min({a.y, b.y, c.y}), std::max({a.y, b.y, c.y}));
    const auto [k0, k1] = range(2, std::min({a.z, b.z, c.z}), std::max({a.z, b.z, c.z}));
    for (std::size_t k = k0; k < k1; ++k)
      for (std::size_t j = j0; j < j1; ++j) meet(a, b, c, j, k);
  }

  std::vector<Crossing>& of(std::size_t j, std::size_t k) { return of_row_[k * rows_.count[1] + j]; }

 private:
  std::pair<std::size_t, std::size_t> range(int axis, double lo, double hi) const {
    const double n = double(rows_.count[std::size_t(axis)]);
    const auto row = [&](double at) { return (at - rows_.origin[axis]) / rows_.spacing; };
    return {std::size_t(std::clamp(std::floor(row(lo)), 0.0, n)),
            std::size_t(std::clamp(std::ceil(row(hi)) + 1, 0.0, n))};
  }
  void meet(const Vec3d& a, const Vec3d& b, const Vec3d& c, std::size_t j, std::size_t k) {
    const Vec3d at = rows_.at(0, j, k);
    const double y = at.y + 3.1e-7 * rows_.spacing, z = at.z + 4.7e-7 * rows_.spacing;
    const double u = side(b, c, y, z), v = side(c, a, y, z), w = side(a, b, y, z);
    const bool positive = u > 0 && v > 0 && w > 0, negative = u <= 0 && v <= 0 && w <= 0 && u + v + w < 0;
    if (positive || negative)
      of(j, k).push_back({(a.x * u + b.x * v + c.x * w) / (u + v + w), positive ? -1 : 1});
  }

  const Rows& rows_;
  std::vector<std::vector<Crossing>> of_row_;
};

}  // namespace

std::vector<Vec3d> fill(const Vec3d& lo, const Vec3d& hi, double spacing, const std::string& name) {
  const Rows rows = rows_of(lo, hi, spacing, name);
  std::vector<Vec3d> points;
  points.reserve(rows.count[0] * rows.count[1] * rows.count[2]);
  for (std::size_t k = 0; k < rows.count[2]; ++k)
    for (std::size_t j = 0; j < rows.count[1]; ++j)
      for (std::size_t i = 0; i < rows.count[0]; ++i) points.push_back(rows.at(i, j, k));
  return points;
}

std::vector<Vec3d> fill(const TriangleMesh& surface, double spacing, const std::string& name) {
  require_closed(inspect(surface), name);
  const BoundingBox box = bounding_box(surface.positions, surface.triangles);
  const Rows rows = rows_of(box.lo, box.hi, spacing, name);
  Crossings crossings(rows);
  for (const Triangle& t : surface.triangles)
    crossings.add(surface.positions[t[0]], surface.positions[t[1]], surface.positions[t[2]]);
  std::vector<Vec3d> points;
  for (std::size_t k = 0; k < rows.count[2]; ++k) {
    for (std::size_t j = 0; j < rows.count[1]; ++j) {
      std::vector<Crossing>& row = crossings.of(j, k);
      std::sort(row.begin(), row.end(), [](const Crossing& a, const Crossing& b) { return a.x < b.x; });
      std::size_t next = 0;
      int winding = 0;
      for (std::size_t i = 0; i < rows.count[0]; ++i) {
        const Vec3d at = rows.at(i, j, k);
        while (next < row.size() && row[next].x <= at.x) winding += row[next++].change;
        if (winding != 0) points.push_back(at);
      }
    }
  }
  if (points.empty())
    throw Error(fmt::format("{}: no particle of spacing {:g} m fits inside", name, spacing));
  return points;
}

}  // namespace souple
