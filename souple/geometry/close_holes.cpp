#include "souple/geometry/close_holes.h"

#include "souple/geometry/adjacency.h"
#include "souple/geometry/edge_uses.h"
#include "souple/geometry/measures.h"
#include "souple/geometry/mesh_report.h"

#include <algorithm>
#include <map>
#include <utility>

#include <fmt/core.h>

namespace souple {

namespace {

/// Edges (a, b) that occur more often from a to b than from b to a, as often as the difference.
std::vector<Edge> uncancelled_edges(std::span<const Triangle> triangles) {
  std::vector<Edge> edges;
  EdgeUses(triangles).for_each_proper([&](std::span<const EdgeUse> uses) {
    const Edge edge{uses[0].low, uses[0].high};
    int balance = 0;
    for (const EdgeUse& use : uses) balance += use.forward ? 1 : -1;
    for (; balance > 0; --balance) edges.push_back(edge);
    for (; balance < 0; ++balance) edges.push_back({edge[1], edge[0]});
  });
  std::sort(edges.begin(), edges.end());
  return edges;
}

/// Walks along unused edges until it returns to its start, which it does: as many edges leave a vertex as
/// arrive.
std::vector<std::uint32_t> walk(std::multimap<std::uint32_t, std::uint32_t>& next) {
  std::vector<std::uint32_t> loop;
  const std::uint32_t start = next.begin()->first;
  std::uint32_t at = start;
  do {
    const auto edge = next.find(at);
    if (edge == next.end()) break;
    loop.push_back(at);
    at = edge->second;
    next.erase(edge);
  } while (at != start);
  return loop;
}

/// The loops in a closed walk that visits a vertex several times: each ends where it returns to a vertex.
std::vector<std::vector<std::uint32_t>> simple_loops(const std::vector<std::uint32_t>& closed_walk) {
  std::vector<std::vector<std::uint32_t>> loops;
  std::vector<std::uint32_t> open;
  std::map<std::uint32_t, std::size_t> place;  // of each vertex in `open`
  for (const std::uint32_t v : closed_walk) {
    if (const auto seen = place.find(v); seen != place.end()) {
      const std::size_t begin = seen->second;
      loops.emplace_back(open.begin() + std::ptrdiff_t(begin), open.end());
      for (std::size_t i = begin; i < open.size(); ++i) place.erase(open[i]);
      open.resize(begin);
    }
    place[v] = open.size();
    open.push_back(v);
  }
  loops.push_back(std::move(open));
  return loops;
}

Hole hole_of(std::vector<std::uint32_t> loop, std::span<const Vec3d> positions) {
  Hole hole;
  for (const std::uint32_t v : loop) hole.center += positions[v];
  hole.center = hole.center / static_cast<double>(loop.size());
  for (std::size_t i = 0; i < loop.size(); ++i) {
    const Vec3d &a = positions[loop[i]], &b = positions[loop[(i + 1) % loop.size()]],
                &across = positions[loop[(i + loop.size() / 2) % loop.size()]];
    hole.width = std::max(hole.width, length(across - a));
    hole.area += 0.5 * length(cross(a - hole.center, b - hole.center));
  }
  hole.loop = std::move(loop);
  return hole;
}

/// Closes each hole with a fan about its center.
void add_fans(std::span<const Hole> holes, TriangleMesh& mesh) {
  for (const Hole& hole : holes) {
    const auto center = static_cast<std::uint32_t>(mesh.positions.size());
    mesh.positions.push_back(hole.center);
    for (std::size_t i = 0; i < hole.loop.size(); ++i)
      mesh.triangles.push_back({hole.loop[(i + 1) % hole.loop.size()], hole.loop[i], center});
  }
}

}  // namespace

std::vector<Hole> find_holes(std::span<const Vec3d> positions, std::span<const Triangle> triangles) {
  std::multimap<std::uint32_t, std::uint32_t> next;
  for (const auto& [a, b] : uncancelled_edges(triangles)) next.emplace(a, b);
  std::vector<Hole> holes;
  while (!next.empty())
    for (std::vector<std::uint32_t>& loop : simple_loops(walk(next)))
      holes.push_back(hole_of(std::move(loop), positions));
  return holes;
}

std::vector<std::string> ClosedSurface::sentences() const {
  if (holes.empty()) return {};
  return {fmt::format("Closed {}.", describe(holes))};
}

ClosedSurface closed_surface(const TriangleMesh& mesh, const std::string& name) {
  constexpr double largest_share = 0.2;  // of the area of the surface
  check_indices(mesh, name.c_str());
  RepairedSurface repaired = repair(mesh);
  ClosedSurface closed;
  closed.mesh.positions = gather<Vec3d>(repaired.weld, mesh.positions);
  closed.mesh.triangles = std::move(repaired.triangles);
  const bool finite = std::all_of(closed.mesh.positions.begin(), closed.mesh.positions.end(),
                                  [](const Vec3d& x) { return is_finite(x); });
  std::vector<Hole> holes = find_holes(closed.mesh.positions, closed.mesh.triangles);
  double open_area = 0;
  for (const Hole& hole : holes) open_area += hole.area;
  const double area = surface_area(closed.mesh.positions, closed.mesh.triangles);
  if (!finite || !(open_area < largest_share * area)) {
    // The user's mesh first: the message then has the user's numbers.
    const std::string where = holes.empty() ? std::string() : describe(holes);
    require_closed(inspect(mesh), name, where);
    require_closed(inspect(closed.mesh, 0), name, where);
    return closed;
  }
  if (holes.empty()) return closed;
  add_fans(holes, closed.mesh);
  // A piece that was open may have been wound inward.
  wind_consistently(closed.mesh.positions, closed.mesh.triangles);
  closed.holes = std::move(holes);
  return closed;
}

std::string describe(std::span<const Hole> holes) {
  constexpr std::size_t most = 3;
  std::string places;
  for (std::size_t i = 0; i < std::min(most, holes.size()); ++i) {
    const auto& [x, y, z] = holes[i].center;
    places += fmt::format("{}{:.3g} m wide at ({:.3g}, {:.3g}, {:.3g})", i > 0 ? ", " : "", holes[i].width, x,
                          y, z);
  }
  if (holes.size() > most) places += ", ...";
  return fmt::format("{} {} ({})", holes.size(), holes.size() == 1 ? "hole" : "holes", places);
}

}  // namespace souple
