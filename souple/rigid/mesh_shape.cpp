#include "souple/rigid/mesh_shape.h"

#include "souple/geometry/adjacency.h"
#include "souple/state/bytes.h"

#include <algorithm>

namespace souple {
namespace {

constexpr double at_border = 2;

// The lean of a normal from the front, and from the back, where a neighbor that rises falls away.
double lean_of(double sine, bool from_back) {
  return std::clamp(from_back && sine < at_border ? -sine : sine, 0.0, 1.0);
}

}  // namespace

MeshShape::MeshShape(std::span<const Vec3d> positions, std::span<const Triangle> triangles)
    : positions_(positions.begin(), positions.end()), triangles_(triangles.begin(), triangles.end()) {
  const Neighbors next = neighbors();
  wind_alike(next);
  find_leans(next);
  tree_.update(triangles_.size(), [this](std::uint32_t t) { return box_of(t); });
}

Bounds MeshShape::box_of(std::uint32_t t) const {
  const auto [a, b, c] = triangles_[t];
  const Vec3f p(positions_[a]), q(positions_[b]), r(positions_[c]);
  return united(around(p, q, 0), around(q, r, 0));
}

Vec3d MeshShape::normal_of(std::uint32_t t) const {
  const auto [a, b, c] = triangles_[t];
  return normalized(cross(positions_[b] - positions_[a], positions_[c] - positions_[a]));
}

MeshShape::Neighbors MeshShape::neighbors() const {
  const TriangleEdges edges = triangle_edges(triangles_);
  struct Sides {
    std::array<std::uint32_t, 2> triangle{none, none};
    int count = 0;
  };
  std::vector<Sides> sides(edges.edges.size());
  for (std::uint32_t t = 0; t < triangles_.size(); ++t)
    for (const std::uint32_t e : edges.of_triangle[t]) {
      if (e == TriangleEdges::no_edge || normal_of(t) == Vec3d{}) continue;
      if (sides[e].count < 2) sides[e].triangle[static_cast<std::size_t>(sides[e].count)] = t;
      ++sides[e].count;
    }
  Neighbors next(triangles_.size(), {none, none, none});
  for (std::uint32_t t = 0; t < triangles_.size(); ++t)
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t e = edges.of_triangle[t][k];
      if (e == TriangleEdges::no_edge || sides[e].count != 2 || normal_of(t) == Vec3d{}) continue;
      next[t][k] = sides[e].triangle[sides[e].triangle[0] == t ? 1 : 0];
    }
  return next;
}

// Winds each piece as its first triangle. Where that is impossible, as on a Moebius strip, the last edges stay as they are.
void MeshShape::wind_alike(const Neighbors& next) {
  const auto runs = [this](std::uint32_t t, std::uint32_t from, std::uint32_t to) {
    const Triangle& v = triangles_[t];
    for (std::size_t k = 0; k < 3; ++k)
      if (v[k] == from && v[(k + 1) % 3] == to) return true;
    return false;
  };
  pieces_.assign(triangles_.size(), none);
  std::uint32_t count = 0;
  std::vector<std::uint32_t> reached;
  for (std::uint32_t first = 0; first < triangles_.size(); ++first) {
    if (pieces_[first] != none) continue;
    pieces_[first] = count;
    reached.assign(1, first);
    while (!reached.empty()) {
      const std::uint32_t t = reached.back();
      reached.pop_back();
      for (const std::uint32_t u : next[t]) {
        if (u == none || pieces_[u] != none) continue;
        pieces_[u] = count;
        reached.push_back(u);
        const Triangle v = triangles_[t];
        for (std::size_t k = 0; k < 3; ++k)
          if (runs(u, v[k], v[(k + 1) % 3])) {
            std::swap(triangles_[u][1], triangles_[u][2]);
            break;
          }
      }
    }
    ++count;
  }
}

void MeshShape::find_leans(const Neighbors& next) {
  leans_.assign(triangles_.size(), {at_border, at_border, at_border});
  for (std::uint32_t t = 0; t < triangles_.size(); ++t) {
    const Vec3d n = normal_of(t);
    for (const std::uint32_t u : next[t]) {
      if (u == none) continue;
      const Vec3d other = normal_of(u);
      for (std::size_t k = 0; k < 3; ++k) {
        const std::uint32_t from = triangles_[t][k], to = triangles_[t][(k + 1) % 3];
        const Triangle& v = triangles_[u];
        if (std::count(v.begin(), v.end(), from) == 0 || std::count(v.begin(), v.end(), to) == 0) continue;
        const double sine = dot(other, normalized(cross(positions_[to] - positions_[from], n)));
        leans_[t][k] = dot(other, n) < 0 ? (sine >= 0 ? 1 : -1) : sine;
      }
    }
  }
}

ContactTriangle MeshShape::triangle(std::uint32_t t, bool from_back) const {
  const Triangle& v = triangles_[t];
  const std::array<double, 3>& sine = leans_[t];
  const std::size_t second = from_back ? 2 : 1, third = from_back ? 1 : 2;
  return {{positions_[v[0]], positions_[v[second]], positions_[v[third]]},
          {lean_of(sine[from_back ? 2 : 0], from_back), lean_of(sine[1], from_back),
           lean_of(sine[from_back ? 0 : 2], from_back)}};
}

std::uint32_t MeshShape::nearest_vertex(const Vec3d& point) const {
  std::uint32_t nearest = 0;
  double least = std::numeric_limits<double>::infinity();
  const auto distance = [&](const Bounds& box) {
    const Vec3d lo(box.lo), hi(box.hi);
    Vec3d outside;
    for (int k = 0; k < 3; ++k) outside[k] = max(max(lo[k] - point[k], point[k] - hi[k]), 0.0);
    return length_squared(outside);
  };
  tree_.search(
      distance, [&] { return least; },
      [&](std::uint32_t t) {
        for (const std::uint32_t v : triangles_[t]) {
          const double d = length_squared(positions_[v] - point);
          if (d < least || (d == least && v < nearest)) least = d, nearest = v;
        }
      });
  return nearest;
}

std::size_t MeshShape::bytes() const {
  return bytes_of(positions_, triangles_, leans_, pieces_) + tree_.bytes();
}

}  // namespace souple
