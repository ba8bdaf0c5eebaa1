#include "souple/geometry/reorder.h"

#include "souple/error.h"
#include "souple/geometry/measures.h"

#include <algorithm>
#include <array>
#include <numeric>

#include <fmt/core.h>

namespace souple {
namespace {

// Puts two zeros before each of the low 21 bits.
std::uint64_t spread(std::uint64_t x) {
  x &= 0x1fffff;
  x = (x | x << 32) & 0x1f00000000ffff;
  x = (x | x << 16) & 0x1f0000ff0000ff;
  x = (x | x << 8) & 0x100f00f00f00f00f;
  x = (x | x << 4) & 0x10c30c30c30c30c3;
  x = (x | x << 2) & 0x1249249249249249;
  return x;
}

// The vertices each vertex shares an edge with: those of v are items[begin[v] .. begin[v + 1]).
struct Graph {
  std::vector<std::size_t> begin;
  std::vector<std::uint32_t> items;

  Graph(std::span<const Edge> edges, std::size_t vertex_count) : begin(vertex_count + 1, 0) {
    for (const Edge& e : edges)
      for (const std::uint32_t v : e) {
        if (v >= vertex_count)
          throw Error(fmt::format("reorder: an edge names vertex {}, but there are {}", v, vertex_count));
        ++begin[v + std::size_t(1)];
      }
    std::partial_sum(begin.begin(), begin.end(), begin.begin());
    items.resize(begin.back());
    std::vector<std::size_t> next(begin.begin(), begin.end() - 1);
    for (const Edge& e : edges) {
      items[next[e[0]]++] = e[1];
      items[next[e[1]]++] = e[0];
    }
    // Low degree first, once and for all.
    for (std::size_t v = 0; v < vertex_count; ++v)
      std::sort(items.begin() + std::ptrdiff_t(begin[v]), items.begin() + std::ptrdiff_t(begin[v + 1]),
                [&](std::uint32_t a, std::uint32_t b) { return before(a, b); });
  }
  std::size_t degree(std::uint32_t v) const { return begin[v + std::size_t(1)] - begin[v]; }
  bool before(std::uint32_t a, std::uint32_t b) const {
    return degree(a) != degree(b) ? degree(a) < degree(b) : a < b;
  }
};

// Appends the piece of `start` to `order`, breadth first; `visit` marks with `stamp`. Returns where its last
// level starts in `order`.
std::size_t breadth_first(const Graph& graph, std::uint32_t start, std::vector<std::uint32_t>& order,
                          std::vector<std::uint8_t>& visited, std::uint8_t stamp) {
  std::size_t level = order.size();
  order.push_back(start);
  visited[start] = stamp;
  for (std::size_t next = level; next < order.size();) {
    level = next;
    for (const std::size_t end = order.size(); next < end; ++next)
      for (std::size_t i = graph.begin[order[next]]; i < graph.begin[order[next] + std::size_t(1)]; ++i) {
        const std::uint32_t v = graph.items[i];
        if (visited[v] == stamp) continue;
        visited[v] = stamp;
        order.push_back(v);
      }
  }
  return level;
}

}  // namespace

std::vector<std::uint32_t> morton_order(std::span<const Vec3d> positions) {
  const BoundingBox box = bounding_box(positions);
  struct Key {
    std::uint64_t code;
    std::uint32_t vertex;
    bool operator<(const Key& b) const { return code != b.code ? code < b.code : vertex < b.vertex; }
  };
  // One scale for all axes, so that the curve's cells are cubes. Halves: the extent of extreme numbers
  // overflows.
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
        code |= spread(std::uint64_t(std::clamp(t, 0.0, 1.0) * 2097151.0)) << i;
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

std::vector<std::uint32_t> cuthill_mckee_order(std::span<const Edge> edges, std::size_t vertex_count) {
  const Graph graph(edges, vertex_count);
  std::vector<std::uint32_t> order, scratch;
  std::vector<std::uint8_t> visited(vertex_count, 0);
  for (std::uint32_t seed = 0; seed < vertex_count; ++seed) {
    if (visited[seed] != 0) continue;
    // Two sweeps to a far end of the piece; the third one numbers it.
    std::uint32_t start = seed;
    for (const std::uint8_t stamp : {std::uint8_t(1), std::uint8_t(2)}) {
      scratch.clear();
      const std::size_t last_level = breadth_first(graph, start, scratch, visited, stamp);
      start = *std::min_element(scratch.begin() + std::ptrdiff_t(last_level), scratch.end(),
                                [&](std::uint32_t a, std::uint32_t b) { return graph.before(a, b); });
    }
    breadth_first(graph, start, order, visited, 3);
  }
  std::reverse(order.begin(), order.end());
  return order;
}

std::vector<std::uint32_t> inverse_order(std::span<const std::uint32_t> order) {
  std::vector<std::uint32_t> inverse(order.size());
  for (std::uint32_t k = 0; k < order.size(); ++k) inverse[order[k]] = k;
  return inverse;
}

}  // namespace souple
