#include "souple/geometry/adjacency.h"

#include "souple/error.h"
#include "souple/geometry/edge_uses.h"
#include "souple/math/disjoint_sets.h"

#include <algorithm>
#include <map>
#include <string>

#include <fmt/core.h>

namespace souple {
namespace {

Edge edge_at(std::span<const Triangle> triangles, std::size_t slot) {
  const Triangle& t = triangles[slot / 3];
  return {t[slot % 3], t[(slot + 1) % 3]};
}

std::uint32_t opposite_at(std::span<const Triangle> triangles, std::size_t slot) {
  return triangles[slot / 3][(slot + 2) % 3];
}

[[noreturn]] void throw_out_of_range(const std::string& name, const char* kind, std::size_t element,
                                     std::uint32_t vertex, std::size_t vertex_count) {
  throw Error(fmt::format("{}: {} {} names vertex {}, but there are {} vertices (numbered from 0)", name,
                          kind, element, vertex, vertex_count));
}

template <class Element>
void check_range(std::span<const Element> elements, std::size_t vertex_count, const std::string& name,
                 const char* kind) {
  for (std::size_t e = 0; e < elements.size(); ++e)
    for (const std::uint32_t v : elements[e])
      if (v >= vertex_count) throw_out_of_range(name, kind, e, v, vertex_count);
}

template <class Element>
Components components_of(std::span<const Element> elements, std::size_t vertex_count) {
  DisjointSets sets(vertex_count);
  for (const Element& element : elements)
    for (std::size_t i = 1; i < element.size(); ++i) sets.join(element[0], element[i]);
  Components result;
  result.of_vertex.resize(vertex_count);
  for (std::uint32_t v = 0; v < vertex_count; ++v) {
    const std::uint32_t root = sets.root(v);
    result.of_vertex[v] = root == v ? result.count++ : result.of_vertex[root];
  }
  return result;
}

}  // namespace

TriangleEdges triangle_edges(std::span<const Triangle> triangles) {
  // First store in each side the slot where its edge first appears, then number those slots in order.
  std::vector<std::size_t> first_slot(triangles.size() * 3, ~std::size_t{0});
  EdgeUses(triangles).for_each_proper([&](std::span<const EdgeUse> uses) {
    for (const EdgeUse& use : uses) first_slot[use.slot] = uses[0].slot;
  });
  TriangleEdges result;
  result.of_triangle.resize(triangles.size());
  for (std::size_t slot = 0; slot < first_slot.size(); ++slot) {
    std::uint32_t& edge = result.of_triangle[slot / 3][slot % 3];
    const std::size_t origin = first_slot[slot];
    if (origin == ~std::size_t{0}) {
      edge = TriangleEdges::no_edge;
    } else if (origin == slot) {
      edge = static_cast<std::uint32_t>(result.edges.size());
      result.edges.push_back(edge_at(triangles, slot));
    } else {
      edge = result.of_triangle[origin / 3][origin % 3];
    }
  }
  return result;
}

std::vector<Edge> unique_edges(std::span<const Triangle> triangles) {
  return triangle_edges(triangles).edges;
}

std::vector<Edge> unique_edges(std::span<const Tet> tets) {
  std::vector<std::size_t> slots;
  EdgeUses(tets).for_each_proper([&](std::span<const EdgeUse> uses) { slots.push_back(uses[0].slot); });
  std::sort(slots.begin(), slots.end());
  std::vector<Edge> edges;
  edges.reserve(slots.size());
  for (const std::size_t slot : slots) {
    const int(&pair)[2] = EdgeUses::tet_edge[slot % 6];
    edges.push_back({tets[slot / 6][std::size_t(pair[0])], tets[slot / 6][std::size_t(pair[1])]});
  }
  return edges;
}

std::vector<Hinge> interior_edges(std::span<const Triangle> triangles) {
  constexpr std::size_t none = ~std::size_t{0};
  std::vector<std::size_t> next_use(triangles.size() * 3,
                                    none);  // per slot: the next slot with the same edge
  std::size_t count = 0;
  EdgeUses(triangles).for_each_proper([&](std::span<const EdgeUse> uses) {
    for (std::size_t u = 0; u + 1 < uses.size(); ++u) next_use[uses[u].slot] = uses[u + 1].slot, ++count;
  });
  std::vector<Hinge> hinges;
  hinges.reserve(count);
  for (std::size_t first = 0; first < next_use.size(); ++first) {
    const std::size_t second = next_use[first];
    if (second == none) continue;
    const Edge edge = edge_at(triangles, first);
    const std::uint32_t c = opposite_at(triangles, first), d = opposite_at(triangles, second);
    // Two triangles on the same corners, or a needle (a, b, a), have no hinge angle.
    const bool folded = c == d || c == edge[0] || c == edge[1] || d == edge[0] || d == edge[1];
    if (!folded) hinges.push_back({edge[0], edge[1], c, d});
  }
  return hinges;
}

std::vector<Edge> boundary_edges(std::span<const Triangle> triangles) {
  std::vector<std::size_t> slots;
  EdgeUses(triangles).for_each_proper([&](std::span<const EdgeUse> uses) {
    if (uses.size() == 1) slots.push_back(uses[0].slot);
  });
  std::sort(slots.begin(), slots.end());
  std::vector<Edge> edges;
  edges.reserve(slots.size());
  for (const std::size_t slot : slots) edges.push_back(edge_at(triangles, slot));
  return edges;
}

Lists<std::uint32_t> vertex_triangles(std::span<const Triangle> triangles, std::size_t vertex_count) {
  check_range(triangles, vertex_count, "mesh", "triangle");
  // Counts a repeated corner of a triangle once.
  const auto is_new = [](const Triangle& t, std::size_t i) {
    return i == 0 || (t[i] != t[0] && (i == 1 || t[i] != t[1]));
  };
  return Lists<std::uint32_t>(vertex_count, [&](const auto& add) {
    for (std::uint32_t t = 0; t < triangles.size(); ++t)
      for (std::size_t i = 0; i < 3; ++i)
        if (is_new(triangles[t], i)) add(triangles[t][i], t);
  });
}

Components connected_components(std::span<const Edge> edges, std::size_t vertex_count) {
  check_range(edges, vertex_count, "mesh", "edge");
  return components_of(edges, vertex_count);
}

Components connected_components(std::span<const Triangle> triangles, std::size_t vertex_count) {
  check_range(triangles, vertex_count, "mesh", "triangle");
  return components_of(triangles, vertex_count);
}

Components connected_components(std::span<const Tet> tets, std::size_t vertex_count) {
  check_range(tets, vertex_count, "mesh", "tet");
  return components_of(tets, vertex_count);
}

std::vector<Triangle> surface_triangles(std::span<const Tet> tets) {
  // Outward faces of a positively oriented tet; face k is opposite corner k.
  constexpr std::size_t face[4][3] = {{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}};
  struct Use {
    Triangle key;
    std::size_t slot;
    bool operator<(const Use& b) const { return key != b.key ? key < b.key : slot < b.slot; }
  };
  std::vector<Use> uses;
  uses.reserve(tets.size() * 4);
  for (std::size_t t = 0; t < tets.size(); ++t)
    for (std::size_t i = 0; i < 4; ++i) {
      Triangle key{tets[t][face[i][0]], tets[t][face[i][1]], tets[t][face[i][2]]};
      std::sort(key.begin(), key.end());
      uses.push_back({key, t * 4 + i});
    }
  std::sort(uses.begin(), uses.end());
  std::vector<std::size_t> slots;
  for (std::size_t first = 0; first < uses.size();) {
    std::size_t last = first + 1;
    while (last < uses.size() && uses[last].key == uses[first].key) ++last;
    if (last - first == 1) slots.push_back(uses[first].slot);
    first = last;
  }
  std::sort(slots.begin(), slots.end());
  std::vector<Triangle> triangles;
  triangles.reserve(slots.size());
  for (const std::size_t slot : slots) {
    const Tet& tet = tets[slot / 4];
    const std::size_t(&f)[3] = face[slot % 4];
    triangles.push_back({tet[f[0]], tet[f[1]], tet[f[2]]});
  }
  return triangles;
}

namespace {

void check_groups(const std::map<std::string, std::vector<std::uint32_t>>& groups, std::size_t count,
                  const char* name) {
  for (const auto& [group, vertices] : groups)
    for (const std::uint32_t vertex : vertices)
      if (vertex >= count)
        throw Error(fmt::format("{}: the group '{}' names vertex {}, but there are {} vertices", name, group,
                                vertex, count));
}

}  // namespace

void check_indices(const TriangleMesh& mesh, const char* name) {
  check_range(std::span<const Triangle>(mesh.triangles), mesh.positions.size(), name, "triangle");
  check_groups(mesh.groups, mesh.positions.size(), name);
  for (std::size_t f = 0; f < mesh.faces.size(); ++f)
    for (const std::uint32_t vertex : mesh.faces[f])
      if (vertex >= mesh.positions.size())
        throw Error(fmt::format("{}: face {} names vertex {}, but there are {} vertices", name, f, vertex,
                                mesh.positions.size()));
}

void check_indices(const TetMesh& mesh, const char* name) {
  check_range(std::span<const Tet>(mesh.tets), mesh.positions.size(), name, "tet");
  check_groups(mesh.groups, mesh.positions.size(), name);
}

}  // namespace souple
