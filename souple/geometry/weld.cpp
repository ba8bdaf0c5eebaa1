#include "souple/geometry/weld.h"

#include "souple/error.h"
#include "souple/geometry/measures.h"
#include "souple/math/sentinels.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <tuple>

#include <fmt/core.h>

namespace souple {
namespace {

using Cell = std::array<std::int64_t, 3>;

// Cubes no smaller than the tolerance: a partner of a position is in one of 27.
class Cubes {
 public:
  Cubes(std::span<const Vec3d> positions, double tolerance) {
    const BoundingBox bounds = bounding_box(positions);
    lo_ = bounds.lo;
    // Half sizes, because the full extent of extreme coordinates overflows. Cubes are two tolerances wide, so
    // that rounding cannot put partners two cubes apart; at most 2^40 cubes per side are exact in a double.
    double half_extent = 0;
    for (int i = 0; i < 3; ++i) half_extent = std::max(half_extent, bounds.hi[i] / 2 - bounds.lo[i] / 2);
    half_cell_ = std::max(
        {tolerance, half_extent / double(std::int64_t(1) << 40), std::numeric_limits<double>::min()});
  }

  Cell cell_of(const Vec3d& p) const {
    Cell cell{};
    for (int i = 0; i < 3; ++i)
      cell[std::size_t(i)] = std::int64_t(std::floor((p[i] / 2 - lo_[i] / 2) / half_cell_));
    return cell;
  }

 private:
  Vec3d lo_;
  double half_cell_{};
};

struct Occupant {
  Cell cell;
  std::uint32_t vertex;
  friend bool operator<(const Occupant& a, const Occupant& b) {
    return std::tie(a.cell, a.vertex) < std::tie(b.cell, b.vertex);
  }
};

// Finds the cubes with another one among the 26 around them. `cells` are sorted, each once. One pass, in which the
// cubes beside the current one are found by pointers that move with it.
std::vector<char> find_neighbored(const std::vector<Cell>& cells) {
  std::vector<char> neighbored(cells.size(), 0);
  // The cubes after the current one.
  constexpr std::int64_t columns[5][2] = {{0, 0}, {0, 1}, {1, -1}, {1, 0}, {1, 1}};
  std::size_t beside[5] = {};
  for (std::size_t k = 0; k < cells.size(); ++k)
    for (std::size_t c = 0; c < 5; ++c) {
      const std::int64_t x = cells[k][0] + columns[c][0], y = cells[k][1] + columns[c][1];
      const Cell from{x, y, cells[k][2] + (c == 0 ? 1 : -1)}, to{x, y, cells[k][2] + 1};
      std::size_t& at = beside[c];
      while (at < cells.size() && cells[at] < from) ++at;
      for (std::size_t other = at; other < cells.size() && cells[other] <= to; ++other)
        neighbored[k] = neighbored[other] = 1;
    }
  return neighbored;
}

// Whether each vertex has another one in its 27 cubes: in most meshes few have.
std::vector<char> find_crowded(std::span<const Vec3d> positions, const Cubes& cubes) {
  std::vector<Occupant> sorted;
  sorted.reserve(positions.size());
  for (std::uint32_t v = 0; v < positions.size(); ++v)
    if (is_finite(positions[v])) sorted.push_back({cubes.cell_of(positions[v]), v});
  std::sort(sorted.begin(), sorted.end());
  std::vector<Cell> cells;
  for (const Occupant& occupant : sorted)
    if (cells.empty() || cells.back() != occupant.cell) cells.push_back(occupant.cell);
  const std::vector<char> neighbored = find_neighbored(cells);
  std::vector<char> crowded(positions.size(), 0);
  std::size_t cell = 0;
  for (std::size_t k = 0; k < sorted.size(); ++k) {
    const bool shares_last = k > 0 && sorted[k].cell == sorted[k - 1].cell;
    const bool shares_next = k + 1 < sorted.size() && sorted[k].cell == sorted[k + 1].cell;
    if (k > 0 && !shares_last) ++cell;
    crowded[sorted[k].vertex] = char(shares_last || shares_next || neighbored[cell] != 0);
  }
  return crowded;
}

// Representatives in their cubes; a cube holds few, because they are more than a tolerance apart.
class CellGrid {
 public:
  CellGrid(std::span<const Vec3d> positions, const Cubes& cubes, const std::vector<char>& crowded)
      : positions_(positions), cubes_(cubes) {
    for (std::size_t v = 0; v < positions.size(); ++v)
      if (crowded[v]) cells_.push_back(cubes.cell_of(positions[v]));
    std::sort(cells_.begin(), cells_.end());
    cells_.erase(std::unique(cells_.begin(), cells_.end()), cells_.end());
    head_.assign(cells_.size(), no_index);
    next_.assign(positions.size(), no_index);
  }

  void insert(std::uint32_t vertex) {
    const Cell cell = cubes_.cell_of(positions_[vertex]);
    const auto at = std::lower_bound(cells_.begin(), cells_.end(), cell) - cells_.begin();
    next_[vertex] = head_[std::size_t(at)];
    head_[std::size_t(at)] = vertex;
  }

  // The lowest inserted vertex within the tolerance of position p, or none.
  std::uint32_t find(const Vec3d& p, double tolerance) const {
    const Cell center = cubes_.cell_of(p);
    std::uint32_t best = no_index;
    for (std::int64_t dx = -1; dx <= 1; ++dx)
      for (std::int64_t dy = -1; dy <= 1; ++dy) {
        const Cell from{center[0] + dx, center[1] + dy, center[2] - 1};
        const Cell to{center[0] + dx, center[1] + dy, center[2] + 1};
        auto it = std::lower_bound(cells_.begin(), cells_.end(), from);
        for (; it != cells_.end() && !(to < *it); ++it)
          for (std::uint32_t v = head_[std::size_t(it - cells_.begin())]; v != no_index; v = next_[v])
            if (v < best && length(positions_[v] - p) <= tolerance) best = v;
      }
    return best;
  }

 private:
  std::span<const Vec3d> positions_;
  const Cubes& cubes_;
  std::vector<Cell> cells_;          // occupied by crowded vertices, sorted
  std::vector<std::uint32_t> head_;  // per cell: its last representative
  std::vector<std::uint32_t> next_;  // per vertex: the previous representative in its cell
};

// Per vertex: the lowest vertex with equal coordinates.
std::vector<std::uint32_t> exact_representatives(std::span<const Vec3d> positions) {
  std::vector<std::uint32_t> order, representative(positions.size());
  for (std::uint32_t v = 0; v < positions.size(); ++v) {
    representative[v] = v;
    if (is_finite(positions[v])) order.push_back(v);
  }
  std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
    const Vec3d &p = positions[a], &q = positions[b];
    return std::tie(p.x, p.y, p.z, a) < std::tie(q.x, q.y, q.z, b);
  });
  for (std::size_t k = 1; k < order.size(); ++k)
    if (positions[order[k]] == positions[order[k - 1]])
      representative[order[k]] = representative[order[k - 1]];
  return representative;
}

std::vector<std::uint32_t> near_representatives(std::span<const Vec3d> positions, double tolerance) {
  const Cubes cubes(positions, tolerance);
  const std::vector<char> crowded = find_crowded(positions, cubes);
  CellGrid grid(positions, cubes, crowded);
  std::vector<std::uint32_t> representative(positions.size());
  for (std::uint32_t v = 0; v < positions.size(); ++v) {
    representative[v] = v;
    if (!crowded[v]) continue;
    const std::uint32_t found = grid.find(positions[v], tolerance);
    if (found != no_index)
      representative[v] = found;
    else
      grid.insert(v);
  }
  return representative;
}

}  // namespace

double rounding_tolerance(std::span<const Vec3d> positions) {
  const BoundingBox bounds = bounding_box(positions);
  const double diagonal = bounds.diagonal();
  return std::isfinite(diagonal) ? 1e-9 * diagonal : 0;
}

Weld weld_vertices(std::span<const Vec3d> positions, double tolerance) {
  if (!(tolerance >= 0) || !std::isfinite(tolerance))
    throw Error("weld: the tolerance must be 0 (equal coordinates) or a positive length in meters");
  const std::vector<std::uint32_t> representative =
      tolerance > 0 ? near_representatives(positions, tolerance) : exact_representatives(positions);
  Weld weld;
  weld.to_welded.resize(positions.size());
  for (std::uint32_t v = 0; v < positions.size(); ++v) {
    if (representative[v] == v) {
      weld.to_welded[v] = static_cast<std::uint32_t>(weld.to_vertex.size());
      weld.to_vertex.push_back(v);
    } else {
      weld.to_welded[v] = weld.to_welded[representative[v]];
    }
  }
  return weld;
}

WeldedTriangles weld_triangles(const Weld& weld, std::span<const Triangle> triangles) {
  WeldedTriangles result;
  result.triangles.reserve(triangles.size());
  result.source.reserve(triangles.size());
  for (std::uint32_t t = 0; t < triangles.size(); ++t) {
    Triangle welded{};
    for (std::size_t i = 0; i < 3; ++i) {
      if (triangles[t][i] >= weld.to_welded.size())
        throw Error(fmt::format("weld: triangle {} names vertex {}, but the weld has {} vertices", t,
                                triangles[t][i], weld.to_welded.size()));
      welded[i] = weld.to_welded[triangles[t][i]];
    }
    if (welded[0] == welded[1] || welded[1] == welded[2] || welded[2] == welded[0]) continue;
    result.triangles.push_back(welded);
    result.source.push_back(t);
  }
  return result;
}

}  // namespace souple
