#pragma once

#include "souple/geometry/adjacency.h"
#include "souple/world/world.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <span>
#include <vector>

// Counts edges that pass through triangles. It shares no code with the engine's collision detection: its own
// grid (a map of cells) and signs of volumes in double.

namespace souple::test {

/// Points and triangles of several objects.
struct CrossingCounter {
  std::vector<Vec3d> points;
  std::vector<Triangle> triangles;

  void add(std::span<const Vec3f> positions, std::span<const Triangle> of) {
    const auto first = static_cast<std::uint32_t>(points.size());
    for (const Vec3f& p : positions) points.emplace_back(p);
    for (const Triangle& t : of) triangles.push_back({first + t[0], first + t[1], first + t[2]});
  }

  bool passes(const Edge& e, const Triangle& t) const {
    for (const std::uint32_t corner : t)
      if (corner == e[0] || corner == e[1]) return false;
    const Vec3d &p = points[e[0]], &q = points[e[1]], &a = points[t[0]], &b = points[t[1]], &c = points[t[2]];
    // In a flat sheet all volumes below are rounding noise. Boxes that are apart cannot deceive.
    for (int axis = 0; axis < 3; ++axis)
      if (std::min(p[axis], q[axis]) > std::max({a[axis], b[axis], c[axis]}) ||
          std::max(p[axis], q[axis]) < std::min({a[axis], b[axis], c[axis]}))
        return false;
    const auto volume = [](const Vec3d& o, const Vec3d& x, const Vec3d& y, const Vec3d& z) {
      return dot(x - o, cross(y - o, z - o));
    };
    const double before = volume(a, b, c, p), after = volume(a, b, c, q);
    if (!(before * after < 0)) return false;
    const double u = volume(p, q, a, b), v = volume(p, q, b, c), w = volume(p, q, c, a);
    return (u > 0 && v > 0 && w > 0) || (u < 0 && v < 0 && w < 0);
  }

  std::size_t crossings_of_all_pairs() const {
    std::size_t count = 0;
    for (const Edge& edge : unique_edges(triangles))
      for (const Triangle& triangle : triangles) count += passes(edge, triangle) ? 1 : 0;
    return count;
  }

  std::size_t crossings() const {
    using Cell = std::array<long, 3>;
    const std::vector<Edge> edges = unique_edges(triangles);
    double length_of_all = 0;
    for (const Edge& e : edges) length_of_all += length(points[e[0]] - points[e[1]]);
    const double cell =
        std::max(2 * length_of_all / static_cast<double>(std::max<std::size_t>(edges.size(), 1)), 1e-9);
    const auto cells = [&](std::span<const std::uint32_t> corners, const auto& f) {
      Cell lo{}, hi{};
      for (int axis = 0; axis < 3; ++axis) {
        double least = std::numeric_limits<double>::infinity(), most = -least;
        for (const std::uint32_t i : corners) {
          least = std::min(least, points[i][axis]);
          most = std::max(most, points[i][axis]);
        }
        lo[static_cast<std::size_t>(axis)] = std::lround(std::floor(least / cell));
        hi[static_cast<std::size_t>(axis)] = std::lround(std::floor(most / cell));
      }
      for (long x = lo[0]; x <= hi[0]; ++x)
        for (long y = lo[1]; y <= hi[1]; ++y)
          for (long z = lo[2]; z <= hi[2]; ++z) f(Cell{x, y, z});
    };
    std::map<Cell, std::vector<std::size_t>> grid;
    for (std::size_t t = 0; t < triangles.size(); ++t)
      cells(triangles[t], [&](const Cell& at) { grid[at].push_back(t); });
    std::size_t count = 0;
    std::vector<std::size_t> near;
    for (const Edge& edge : edges) {
      near.clear();
      cells(edge, [&](const Cell& at) {
        if (const auto found = grid.find(at); found != grid.end())
          near.insert(near.end(), found->second.begin(), found->second.end());
      });
      std::sort(near.begin(), near.end());
      near.erase(std::unique(near.begin(), near.end()), near.end());
      for (const std::size_t t : near) count += passes(edge, triangles[t]) ? 1 : 0;
    }
    return count;
  }
};

/// All surfaces of a world, including obstacles.
inline CrossingCounter crossing_counter_of(const World& world) {
  CrossingCounter counter;
  for (const ObjectId id : world.objects()) counter.add(world.positions(id), world.triangles(id));
  return counter;
}

/// Edges of a world that pass through triangles.
inline std::size_t crossings(const World& world) {
  return crossing_counter_of(world).crossings();
}

}  // namespace souple::test
