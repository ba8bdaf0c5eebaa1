#include "souple/geometry/embedding.h"

#include "souple/error.h"
#include "souple/geometry/adjacency.h"
#include "souple/geometry/measures.h"
#include "souple/math/elementary.h"
#include "souple/math/lists.h"
#include "souple/math/mat3.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/core.h>

namespace souple {
namespace {

using Weights = std::array<double, 4>;
constexpr double no_distance = std::numeric_limits<double>::infinity();
// A tet whose volume is below this fraction of its longest edge cubed is degenerate and carries no points.
constexpr double flat_tet = 1e-12;
// Tolerance of barycentric weights for a point on a face, for rounding on shared faces.
constexpr double on_face = 1e-9;

bool has_volume(const TetMesh& mesh, const Tet& t) {
  double longest = 0;
  for (std::size_t i = 0; i < 4; ++i)
    for (std::size_t j = i + 1; j < 4; ++j)
      longest = std::max(longest, length(mesh.positions[t[i]] - mesh.positions[t[j]]));
  const Vec3d& a = mesh.positions[t[0]];
  const double six_volumes =
      dot(cross(mesh.positions[t[1]] - a, mesh.positions[t[2]] - a), mesh.positions[t[3]] - a);
  return std::abs(six_volumes) > flat_tet * longest * longest * longest;
}

Weights barycentric(const TetMesh& mesh, const Tet& t, const Vec3d& p) {
  const Vec3d& a = mesh.positions[t[0]];
  const Mat3d edges{mesh.positions[t[1]] - a, mesh.positions[t[2]] - a, mesh.positions[t[3]] - a};
  const Vec3d w = inverse(edges) * (p - a);
  return {1 - w.x - w.y - w.z, w.x, w.y, w.z};
}

double smallest(const Weights& w) {
  return std::min(std::min(w[0], w[1]), std::min(w[2], w[3]));
}

// Distance from p to the triangle a b c, by Voronoi regions of its corners, edges and face.
double triangle_distance(const Vec3d& p, const Vec3d& a, const Vec3d& b, const Vec3d& c) {
  const auto segment = [&](const Vec3d& s, const Vec3d& e) {
    const double l2 = length_squared(e - s);
    const double t = l2 > 0 ? std::clamp(dot(p - s, e - s) / l2, 0.0, 1.0) : 0.0;
    return length(s + (e - s) * t - p);
  };
  const Vec3d n = cross(b - a, c - a);
  const double n2 = length_squared(n);
  if (n2 > 0) {
    const double u = dot(cross(b - a, p - a), n), v = dot(cross(c - b, p - b), n),
                 w = dot(cross(a - c, p - c), n);
    if (u >= 0 && v >= 0 && w >= 0) return std::abs(dot(p - a, n)) / std::sqrt(n2);
  }
  return std::min({segment(a, b), segment(b, c), segment(c, a)});
}

double tet_distance(const TetMesh& mesh, const Tet& t, const Vec3d& p) {
  if (smallest(barycentric(mesh, t, p)) >= 0) return 0;
  constexpr std::size_t face[4][3] = {{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}};
  double best = no_distance;
  for (const auto& f : face)
    best = std::min(best, triangle_distance(p, mesh.positions[t[f[0]]], mesh.positions[t[f[1]]],
                                            mesh.positions[t[f[2]]]));
  return best;
}

// The tets that overlap each cube of a uniform grid over the mesh; about one cube per tet.
class TetGrid {
 public:
  explicit TetGrid(const TetMesh& mesh, const std::vector<std::uint32_t>& usable) {
    const BoundingBox box = used_box(mesh, usable);
    lo_ = box.lo;
    const Vec3d size = box.size();
    const double largest = std::max({size.x, size.y, size.z});
    // Flat directions have one layer; the other axes share the cubes in proportion to their length.
    const double wanted = std::min(double(usable.size()), 4e6);
    cell_ = std::max(elementary::cbrt(size.x * size.y * size.z / wanted), largest / 256);
    for (std::size_t i = 0; i < 3; ++i)
      count_[i] = std::max(1, int(std::min(256.0, std::floor(size[int(i)] / cell_) + 1)));
    fill(mesh, usable);
  }

  std::array<int, 3> cell_of(const Vec3d& p) const {
    std::array<int, 3> c{};
    for (std::size_t i = 0; i < 3; ++i)
      c[i] = int(std::clamp(std::floor((p[int(i)] - lo_[int(i)]) / cell_), 0.0, double(count_[i] - 1)));
    return c;
  }

  std::span<const std::uint32_t> tets_at(const std::array<int, 3>& c) const { return tets_[flat(c)]; }

  // Calls visit(cell) for the cells of the shell at `ring` cells around `center`; returns false if the whole
  // shell is outside the grid.
  template <class Visit>
  bool for_shell(const std::array<int, 3>& center, int ring, const Visit& visit) const {
    std::array<int, 3> lo{}, hi{};
    bool any = false;
    for (std::size_t i = 0; i < 3; ++i) {
      any = any || center[i] - ring >= 0 || center[i] + ring < count_[i];
      lo[i] = std::max(0, center[i] - ring);
      hi[i] = std::min(count_[i] - 1, center[i] + ring);
    }
    if (!any) return false;
    for (int z = lo[2]; z <= hi[2]; ++z)
      for (int y = lo[1]; y <= hi[1]; ++y) {
        const bool whole_row = std::abs(z - center[2]) == ring || std::abs(y - center[1]) == ring;
        for (int x = lo[0]; x <= hi[0]; ++x)
          if (whole_row || std::abs(x - center[0]) == ring) visit(std::array<int, 3>{x, y, z});
      }
    return true;
  }

  double cell_size() const { return cell_; }
  // The point of the grid's box nearest to p.
  Vec3d clamped(const Vec3d& p) const {
    Vec3d q = p;
    for (int i = 0; i < 3; ++i)
      q[i] = std::clamp(p[i], lo_[i], lo_[i] + cell_ * double(count_[std::size_t(i)]));
    return q;
  }

 private:
  static BoundingBox used_box(const TetMesh& mesh, const std::vector<std::uint32_t>& usable) {
    std::vector<Vec3d> corners;
    corners.reserve(usable.size() * 4);
    for (const std::uint32_t t : usable)
      for (const std::uint32_t v : mesh.tets[t]) corners.push_back(mesh.positions[v]);
    return bounding_box(corners);
  }

  std::size_t flat(const std::array<int, 3>& c) const {
    return (std::size_t(c[2]) * std::size_t(count_[1]) + std::size_t(c[1])) * std::size_t(count_[0]) +
           std::size_t(c[0]);
  }

  template <class Visit>
  void for_cells_of(const TetMesh& mesh, const Tet& t, const Visit& visit) const {
    Vec3d lo = mesh.positions[t[0]], hi = lo;
    for (const std::uint32_t v : t)
      for (int i = 0; i < 3; ++i) {
        lo[i] = std::min(lo[i], mesh.positions[v][i]);
        hi[i] = std::max(hi[i], mesh.positions[v][i]);
      }
    const Vec3d rim = Vec3d{1, 1, 1} * (1e-6 * cell_);  // a point on a face finds the tets of both sides
    const std::array<int, 3> first = cell_of(lo - rim), last = cell_of(hi + rim);
    for (int z = first[2]; z <= last[2]; ++z)
      for (int y = first[1]; y <= last[1]; ++y)
        for (int x = first[0]; x <= last[0]; ++x) visit(flat({x, y, z}));
  }

  void fill(const TetMesh& mesh, const std::vector<std::uint32_t>& usable) {
    const std::size_t cells = std::size_t(count_[0]) * std::size_t(count_[1]) * std::size_t(count_[2]);
    tets_.fill(cells, [&](const auto& add) {
      for (const std::uint32_t t : usable)
        for_cells_of(mesh, mesh.tets[t], [&](std::size_t c) { add(c, t); });
    });
  }

  Vec3d lo_;
  double cell_{};
  std::array<int, 3> count_{};
  Lists<std::uint32_t> tets_;  // per cube
};

struct Host {
  std::uint32_t tet;
  double distance;
};

// The first tet in p's cube that contains p, else the nearest tet of all.
Host find_host(const TetMesh& mesh, const TetGrid& grid, const Vec3d& p) {
  const std::array<int, 3> center = grid.cell_of(p);
  for (const std::uint32_t t : grid.tets_at(center))
    if (smallest(barycentric(mesh, mesh.tets[t], p)) >= -on_face) return {t, 0};
  Host best{std::numeric_limits<std::uint32_t>::max(), no_distance};
  const double to_box = length(grid.clamped(p) - p);
  for (int ring = 0;; ++ring) {
    const bool more = grid.for_shell(center, ring, [&](const std::array<int, 3>& cell) {
      for (const std::uint32_t t : grid.tets_at(cell)) {
        const double d = tet_distance(mesh, mesh.tets[t], p);
        if (d < best.distance || (d == best.distance && t < best.tet)) best = {t, d};
      }
    });
    // Tets in further shells are at least `ring` cubes from the cube of p, or of its projection on the box.
    if (!more || best.distance <= std::max(double(ring) * grid.cell_size(), to_box)) break;
  }
  return best;
}

std::vector<std::uint32_t> usable_tets(const TetMesh& mesh) {
  check_indices(mesh, "embedding");
  std::vector<std::uint32_t> usable;
  for (std::uint32_t t = 0; t < mesh.tets.size(); ++t) {
    for (const std::uint32_t v : mesh.tets[t])
      if (!is_finite(mesh.positions[v]))
        throw Error(fmt::format("embedding: vertex {} of the tet mesh is not finite", v));
    if (has_volume(mesh, mesh.tets[t])) usable.push_back(t);
  }
  if (usable.empty()) throw Error("embedding: the tet mesh has no tet with a volume");
  return usable;
}

}  // namespace

Embedding embed(std::span<const Vec3d> points, const TetMesh& mesh) {
  const TetGrid grid(mesh, usable_tets(mesh));
  Embedding result;
  result.vertices.reserve(points.size());
  result.weights.reserve(points.size());
  result.tets.reserve(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (!is_finite(points[i])) throw Error(fmt::format("embedding: point {} is not finite", i));
    const Host host = find_host(mesh, grid, points[i]);
    if (!std::isfinite(host.distance))
      throw Error(fmt::format("embedding: point {} is too far from the tet mesh to measure the distance", i));
    result.tets.push_back(host.tet);
    result.vertices.push_back(mesh.tets[host.tet]);
    result.weights.push_back(barycentric(mesh, mesh.tets[host.tet], points[i]));
    if (host.distance > 0) {
      ++result.outside;
      result.largest_distance = std::max(result.largest_distance, host.distance);
    }
  }
  return result;
}

}  // namespace souple
