#include "souple/geometry/mesh_report.h"

#include "souple/error.h"
#include "souple/geometry/edge_uses.h"
#include "souple/geometry/measures.h"
#include "souple/math/lists.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <tuple>
#include <utility>

#include <fmt/core.h>

namespace souple {
namespace {

using Indices = std::vector<std::uint32_t>;

bool has_zero_area(std::span<const Vec3d> positions, const Triangle& t) {
  const Vec3d a = positions[t[0]], ab = positions[t[1]] - a, ac = positions[t[2]] - a;
  const double longest =
      std::max({length_squared(ab), length_squared(ac), length_squared(positions[t[2]] - positions[t[1]])});
  return !(length(cross(ab, ac)) > 1e-10 * longest);
}

bool all_finite(std::span<const Vec3d> positions, const Triangle& t) {
  return is_finite(positions[t[0]]) && is_finite(positions[t[1]]) && is_finite(positions[t[2]]);
}

void find_edges(MeshReport& report, const Weld& weld, std::span<const Triangle> triangles) {
  const EdgeUses edges(triangles);
  bool even = true;
  for (std::size_t e = 0; e < edges.size(); ++e) {
    const std::span<const EdgeUse> uses = edges[e];
    const Edge edge{weld.to_vertex[uses[0].low], weld.to_vertex[uses[0].high]};
    even = even && uses.size() % 2 == 0;
    if (uses.size() == 1) report.open_edges.push_back(edge);
    if (uses.size() > 2) report.non_manifold_edges.push_back(edge);
    if (uses.size() == 2 && uses[0].forward == uses[1].forward) report.inconsistent_edges.push_back(edge);
  }
  report.is_closed = even && !triangles.empty() && report.non_finite_vertices.empty();
}

std::string plural(std::size_t count, const std::string& singular, const std::string& many) {
  return fmt::format("{} {}", count, count == 1 ? singular : many);
}

std::string place_of(const Indices& list) {
  return fmt::format("{}number {}", list.size() == 1 ? "" : "the first is ", list[0]);
}

std::string place_of(const std::vector<Edge>& list) {
  return fmt::format("{}between vertices {} and {}", list.size() == 1 ? "" : "the first is ", list[0][0],
                     list[0][1]);
}

}  // namespace

bool MeshReport::is_clean() const {
  return describe(*this).empty();
}

MeshReport inspect(const TriangleMesh& mesh, double tolerance) {
  check_indices(mesh);
  MeshReport report;
  report.vertex_count = mesh.positions.size();
  report.triangle_count = mesh.triangles.size();
  const Weld weld = weld_vertices(mesh.positions, tolerance);
  std::vector<bool> used(mesh.positions.size(), false), part_used(weld.size(), false);
  for (const Triangle& t : mesh.triangles)
    for (const std::uint32_t v : t) {
      used[v] = true;
      part_used[weld.to_welded[v]] = true;
    }
  for (std::uint32_t v = 0; v < mesh.positions.size(); ++v) {
    if (!is_finite(mesh.positions[v])) report.non_finite_vertices.push_back(v);
    if (!used[v]) report.unreferenced_vertices.push_back(v);
    if (weld.to_vertex[weld.to_welded[v]] != v) report.duplicate_vertices.push_back(v);
  }
  const WeldedTriangles welded = weld_triangles(weld, mesh.triangles);
  std::vector<bool> survives(mesh.triangles.size(), false);
  for (const std::uint32_t t : welded.source) survives[t] = true;
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    if (!survives[t])
      report.collapsed_triangles.push_back(t);
    else if (all_finite(mesh.positions, mesh.triangles[t]) &&
             has_zero_area(mesh.positions, mesh.triangles[t]))
      report.zero_area_triangles.push_back(t);
  }
  find_edges(report, weld, welded.triangles);
  const Components parts = connected_components(welded.triangles, weld.size());
  std::vector<bool> seen(parts.count, false);
  for (std::size_t v = 0; v < weld.size(); ++v)
    if (part_used[v] && !seen[parts.of_vertex[v]]) {
      seen[parts.of_vertex[v]] = true;
      ++report.pieces;
    }
  if (report.is_closed) report.signed_volume = enclosed_volume(mesh.positions, mesh.triangles);
  return report;
}

MeshReport inspect(const TriangleMesh& mesh) {
  return inspect(mesh, rounding_tolerance(mesh.positions));
}

std::vector<std::string> describe(const MeshReport& r) {
  std::vector<std::string> lines;
  const auto add = [&](const auto& list, const char* one, const char* many) {
    if (!list.empty()) lines.push_back(plural(list.size(), one, many) + " (" + place_of(list) + ")");
  };
  add(r.non_finite_vertices, "vertex is not a finite number", "vertices are not finite numbers");
  add(r.unreferenced_vertices, "vertex is in no triangle", "vertices are in no triangle");
  add(r.duplicate_vertices, "vertex coincides with an earlier one", "vertices coincide with earlier ones");
  add(r.collapsed_triangles, "triangle has two coincident corners", "triangles have two coincident corners");
  add(r.zero_area_triangles, "triangle has no area", "triangles have no area");
  add(r.open_edges, "edge is open", "edges are open");
  add(r.non_manifold_edges, "edge is shared by more than two triangles",
      "edges are shared by more than two triangles");
  add(r.inconsistent_edges, "edge joins triangles of opposite winding",
      "edges join triangles of opposite winding");
  return lines;
}

void require_closed(const MeshReport& r, const std::string& name, const std::string& holes) {
  if (r.is_closed) return;
  std::string why;
  const auto add = [&](const std::string& reason) { why += (why.empty() ? "" : ", ") + reason; };
  if (r.triangle_count == 0) add("it has no triangles");
  if (!r.non_finite_vertices.empty())
    add(plural(r.non_finite_vertices.size(), "vertex is", "vertices are") + " not finite (" +
        place_of(r.non_finite_vertices) + ")");
  if (!r.open_edges.empty())
    add(plural(r.open_edges.size(), "edge is", "edges are") + " open (" + place_of(r.open_edges) + ")");
  else if (!r.non_manifold_edges.empty())
    add(plural(r.non_manifold_edges.size(), "edge is", "edges are") +
        " shared by more than two triangles, some by an odd number (" + place_of(r.non_manifold_edges) + ")");
  if (why.empty()) add("all its triangles are collapsed");
  if (!holes.empty()) why += ", it has " + holes;
  throw Error(name + ": a closed surface is needed here, but " + why +
              "; close it in a modeling program (in Blender: a Remesh modifier); only cloth and obstacles "
              "may be open");
}

namespace {

// The neighbor of a triangle across an edge of exactly two triangles, and whether their windings agree.
struct Neighbor {
  std::uint32_t triangle;
  bool agrees;
};

std::vector<std::array<Neighbor, 3>> neighbors_of(const EdgeUses& edges, std::size_t triangle_count) {
  constexpr std::uint32_t nobody = ~std::uint32_t(0);
  const Neighbor alone{nobody, true};
  std::vector<std::array<Neighbor, 3>> result(triangle_count, {alone, alone, alone});
  for (std::size_t e = 0; e < edges.size(); ++e) {
    if (edges[e].size() != 2) continue;
    const EdgeUse &a = edges[e][0], &b = edges[e][1];
    const bool agrees = a.forward != b.forward;
    result[a.slot / 3][a.slot % 3] = {static_cast<std::uint32_t>(b.slot / 3), agrees};
    result[b.slot / 3][b.slot % 3] = {static_cast<std::uint32_t>(a.slot / 3), agrees};
  }
  return result;
}

// Triangles connected through edges of exactly two, and those to reverse for a consistent winding.
struct Patch {
  Indices triangles;
  bool orientable = true;
};

std::vector<Patch> find_patches(const EdgeUses& edges, std::size_t triangle_count,
                                std::vector<char>& flipped) {
  const auto neighbors = neighbors_of(edges, triangle_count);
  std::vector<char> seen(triangle_count, 0);
  std::vector<Patch> patches;
  for (std::uint32_t seed = 0; seed < triangle_count; ++seed) {
    if (seen[seed]) continue;
    Patch patch;
    patch.triangles.push_back(seed);
    seen[seed] = 1;
    for (std::size_t next = 0; next < patch.triangles.size(); ++next) {
      const std::uint32_t t = patch.triangles[next];
      for (const auto& [other, agrees] : neighbors[t]) {
        if (other >= triangle_count) continue;
        const char turned = agrees ? flipped[t] : char(!flipped[t]);
        if (!seen[other]) {
          seen[other] = 1;
          flipped[other] = turned;
          patch.triangles.push_back(other);
        } else if (flipped[other] != turned) {
          patch.orientable = false;
        }
      }
    }
    patches.push_back(std::move(patch));
  }
  return patches;
}

// Reverses the minority of a patch's triangles; a patch without a consistent winding is unchanged.
void keep_majority(const Patch& patch, std::vector<char>& flipped) {
  std::size_t turned = 0;
  for (const std::uint32_t t : patch.triangles) turned += flipped[t] ? 1u : 0u;
  const bool invert = turned * 2 > patch.triangles.size();
  for (const std::uint32_t t : patch.triangles)
    flipped[t] = patch.orientable ? char(invert ? !flipped[t] : flipped[t]) : char(0);
}

void turn_over(std::vector<Triangle>& triangles, const Indices& which) {
  for (const std::uint32_t t : which) std::swap(triangles[t][1], triangles[t][2]);
}

struct ClosedPiece {
  const Indices* triangles;
  double volume;
  BoundingBox box;
};

bool lies_within(const BoundingBox& inner, const BoundingBox& outer) {
  for (int i = 0; i < 3; ++i)
    if (!(inner.lo[i] > outer.lo[i] && inner.hi[i] < outer.hi[i])) return false;
  return true;
}

// A patch without open edges and without edges shared with other patches.
bool is_closed_patch(const Patch& patch, const std::vector<char>& on_rim) {
  return patch.orientable && std::none_of(patch.triangles.begin(), patch.triangles.end(),
                                          [&](std::uint32_t t) { return on_rim[t] != 0; });
}

std::vector<ClosedPiece> closed_pieces(const std::vector<Patch>& patches, const std::vector<char>& on_rim,
                                       std::span<const Vec3d> positions,
                                       std::span<const Triangle> triangles) {
  std::vector<ClosedPiece> pieces;
  for (const Patch& patch : patches) {
    if (!is_closed_patch(patch, on_rim)) continue;
    std::vector<Triangle> own;
    for (const std::uint32_t t : patch.triangles) own.push_back(triangles[t]);
    pieces.push_back({&patch.triangles, enclosed_volume(positions, own), bounding_box(positions, own)});
  }
  return pieces;
}

// Finds boxes around a box. A tree over the pieces, sorted by the lowest x, holds the highest x of each branch. So a
// search visits only pieces that reach around the box along x.
class Surroundings {
 public:
  explicit Surroundings(const std::vector<ClosedPiece>& pieces) {
    for (const ClosedPiece& piece : pieces)
      if (!std::isnan(piece.box.lo.x) && !std::isnan(piece.box.hi.x)) boxes_.push_back(piece.box);
    std::sort(boxes_.begin(), boxes_.end(),
              [](const BoundingBox& s, const BoundingBox& t) { return s.lo.x < t.lo.x; });
    while (leaves_ < boxes_.size()) leaves_ *= 2;
    highest_.assign(2 * leaves_, -std::numeric_limits<double>::infinity());
    for (std::size_t i = 0; i < boxes_.size(); ++i) highest_[leaves_ + i] = boxes_[i].hi.x;
    for (std::size_t n = leaves_; n-- > 1;) highest_[n] = std::max(highest_[2 * n], highest_[2 * n + 1]);
  }

  // Whether another piece's box surrounds this one: strictly, so that no box surrounds itself.
  bool surround(const BoundingBox& box) const { return surround(box, 1, 0, leaves_); }

 private:
  bool surround(const BoundingBox& box, std::size_t node, std::size_t begin, std::size_t end) const {
    if (begin >= boxes_.size() || !(boxes_[begin].lo.x < box.lo.x) || !(highest_[node] > box.hi.x))
      return false;
    if (end - begin == 1) return lies_within(box, boxes_[begin]);
    const std::size_t middle = begin + (end - begin) / 2;
    return surround(box, 2 * node, begin, middle) || surround(box, 2 * node + 1, middle, end);
  }

  std::vector<BoundingBox> boxes_;
  std::size_t leaves_ = 1;
  std::vector<double> highest_;  // [m] of the boxes below each node; node n is over 2 n and 2 n + 1
};

// Reverses closed pieces that are inside out, except possible walls of cavities.
std::size_t turn_outward(const std::vector<ClosedPiece>& pieces, std::vector<Triangle>& triangles) {
  const Surroundings surroundings(pieces);
  std::size_t turned = 0;
  for (const ClosedPiece& piece : pieces) {
    if (!(piece.volume < 0) || surroundings.surround(piece.box)) continue;
    turn_over(triangles, *piece.triangles);
    ++turned;
  }
  return turned;
}

// Marks duplicates: all but the first of triangles with equal corners.
std::vector<char> find_copies(std::span<const Triangle> triangles) {
  struct Key {
    std::uint32_t middle, high, triangle;
  };
  // First by the lowest corner, by counting: each has few triangles, which are then sorted.
  std::size_t vertices = 0;
  for (const Triangle& t : triangles)
    vertices = std::max(vertices, std::max({t[0], t[1], t[2]}) + std::size_t{1});
  Lists<Key> keys(vertices, [&](const auto& add) {
    for (std::uint32_t t = 0; t < triangles.size(); ++t) {
      Triangle corners = triangles[t];
      std::sort(corners.begin(), corners.end());
      add(corners[0], {corners[1], corners[2], t});
    }
  });
  std::vector<char> copy(triangles.size(), 0);
  for (std::size_t v = 0; v < vertices; ++v) {
    const std::span<Key> of_vertex = keys[v];
    std::sort(of_vertex.begin(), of_vertex.end(), [&](const Key& a, const Key& b) {
      return std::tie(a.middle, a.high, a.triangle) < std::tie(b.middle, b.high, b.triangle);
    });
    for (std::size_t k = 1; k < of_vertex.size(); ++k) {
      const Key &a = of_vertex[k], &b = of_vertex[k - 1];
      copy[a.triangle] = a.middle == b.middle && a.high == b.high;
    }
  }
  return copy;
}

// Removes the triangles without `keep`, and reports their number and the reason.
template <class Keep>
void filter(RepairedSurface& surface, const Keep& keep, const char* why) {
  std::size_t kept = 0;
  for (std::size_t t = 0; t < surface.triangles.size(); ++t) {
    if (!keep(t)) continue;
    surface.triangles[kept] = surface.triangles[t];
    surface.source[kept] = surface.source[t];
    ++kept;
  }
  const std::size_t dropped = surface.triangles.size() - kept;
  surface.triangles.resize(kept);
  surface.source.resize(kept);
  if (dropped > 0)
    surface.sentences.push_back("Dropped " + plural(dropped, "triangle", "triangles") + " " + why + ".");
}

bool every_edge_is_even(std::span<const Triangle> triangles) {
  const EdgeUses edges(triangles);
  for (std::size_t e = 0; e < edges.size(); ++e)
    if (edges[e].size() % 2 != 0) return false;
  return true;
}

}  // namespace

std::vector<std::string> wind_consistently(std::span<const Vec3d> positions,
                                           std::vector<Triangle>& triangles) {
  std::vector<std::string> sentences;
  const EdgeUses edges(triangles);
  std::vector<char> flipped(triangles.size(), 0), on_rim(triangles.size(), 0);
  for (std::size_t e = 0; e < edges.size(); ++e)
    if (edges[e].size() != 2)
      for (const EdgeUse& use : edges[e]) on_rim[use.slot / 3] = 1;
  const std::vector<Patch> patches = find_patches(edges, triangles.size(), flipped);
  std::size_t one_sided = 0;
  for (const Patch& patch : patches) {
    keep_majority(patch, flipped);
    one_sided += patch.orientable ? 0u : 1u;
  }
  Indices turned;
  for (std::uint32_t t = 0; t < flipped.size(); ++t)
    if (flipped[t]) turned.push_back(t);
  turn_over(triangles, turned);
  const std::size_t outward = turn_outward(closed_pieces(patches, on_rim, positions, triangles), triangles);
  if (!turned.empty())
    sentences.push_back("Reversed " + plural(turned.size(), "triangle", "triangles") +
                        " to match the winding of the others.");
  if (outward > 0)
    sentences.push_back("Reversed " + plural(outward, "closed piece", "closed pieces") + " to face outward.");
  if (one_sided > 0)
    sentences.push_back("Left " + plural(one_sided, "piece", "pieces") +
                        " with mixed winding: such a surface has only one side (a Moebius strip).");
  return sentences;
}

RepairedSurface repair(const TriangleMesh& mesh, double tolerance) {
  check_indices(mesh);
  RepairedSurface surface;
  surface.weld = weld_vertices(mesh.positions, tolerance);
  const std::size_t joined = mesh.positions.size() - surface.weld.size();
  if (joined > 0)
    surface.sentences.push_back("Joined " + plural(joined, "vertex", "vertices") + " with coincident ones.");
  WeldedTriangles welded = weld_triangles(surface.weld, mesh.triangles);
  const std::size_t collapsed = mesh.triangles.size() - welded.triangles.size();
  if (collapsed > 0)
    surface.sentences.push_back("Dropped " + plural(collapsed, "triangle", "triangles") +
                                " with two coincident corners.");
  surface.triangles = std::move(welded.triangles);
  surface.source = std::move(welded.source);
  const std::vector<Vec3d> positions = gather<Vec3d>(surface.weld, mesh.positions);
  filter(
      surface, [&](std::size_t t) { return all_finite(positions, surface.triangles[t]); },
      "with a vertex that is not finite");
  const std::vector<char> copy = find_copies(surface.triangles);
  filter(
      surface, [&](std::size_t t) { return !copy[t]; }, "that duplicate another triangle");
  if (!every_edge_is_even(surface.triangles))
    filter(
        surface, [&](std::size_t t) { return !has_zero_area(positions, surface.triangles[t]); },
        "without area");
  for (std::string& sentence : wind_consistently(positions, surface.triangles))
    surface.sentences.push_back(std::move(sentence));
  return surface;
}

RepairedSurface repair(const TriangleMesh& mesh) {
  return repair(mesh, rounding_tolerance(mesh.positions));
}

}  // namespace souple
