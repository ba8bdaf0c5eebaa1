#include "souple/geometry/lattice.h"

#include "souple/error.h"
#include "souple/geometry/adjacency.h"
#include "souple/geometry/close_holes.h"
#include "souple/geometry/measures.h"
#include "souple/math/elementary.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

#include <fmt/core.h>

// How the lattice is cut. Space is filled with unit cubes; the lattice's points are their corners and their
// centers. Two cubes that share a face give four tets: the segment between the two centers, with each of the
// four edges of the face. Seen along axis d, the face of corners p0 p1 p2 p3 and its tets (quadrants) 0..3:
//
//      p3 --2-- p2      v
//      |  \  /  |       ^
//      3   cc   1       |        cc: the two centers, one below the face, one above
//      |  /  \  |       +--> u   u = d + 1, v = d + 2 (mod 3)
//      p0 --0-- p1
//
// The tets fill space, so every point of the surface is in a tet. Triangle-tet tests find the tets near the
// surface. The rest of space is entirely inside or entirely outside. A flood fill from the lattice's rim finds the
// outside, without rays that could graze an edge. Only regions that the flood cannot reach (the inside, and cavities)
// need a winding number, one per region.

namespace souple {
namespace {

using Cube = std::array<int, 3>;
using Points3 = std::array<Vec3d, 3>;
using Points4 = std::array<Vec3d, 4>;

constexpr double max_cubes = 4e6;
constexpr int margin = 2;         // cubes around the surface, for the flood fill
constexpr double contact = 1e-9;  // in cubes; a smaller overlap is a contact, a deeper one a crossing

enum Mark : std::uint8_t { clear, touched, crossed, inside, outside };

struct TetId {
  Cube cube;  // the cube above the face
  int axis, quadrant;
};

/// The numbering of cubes, tets and points.
struct LatticeIndex {
  Cube count;

  std::size_t cubes() const { return std::size_t(count[0]) * std::size_t(count[1]) * std::size_t(count[2]); }
  std::size_t tets() const { return cubes() * 12; }
  bool has(const Cube& c) const {
    for (std::size_t i = 0; i < 3; ++i)
      if (c[i] < 0 || c[i] >= count[i]) return false;
    return true;
  }
  // A tet exists if the cubes on both sides of its face exist.
  bool has(const TetId& t) const { return has(t.cube) && t.cube[std::size_t(t.axis)] >= 1; }
  std::size_t cube_number(const Cube& c) const {
    return (std::size_t(c[2]) * std::size_t(count[1]) + std::size_t(c[1])) * std::size_t(count[0]) +
           std::size_t(c[0]);
  }
  std::size_t number(const TetId& t) const {
    return (cube_number(t.cube) * 3 + std::size_t(t.axis)) * 4 + std::size_t(t.quadrant);
  }
  TetId tet(std::size_t number) const {
    std::size_t cube = number / 12;
    const std::size_t x = cube % std::size_t(count[0]);
    cube /= std::size_t(count[0]);
    const std::size_t y = cube % std::size_t(count[1]), z = cube / std::size_t(count[1]);
    return {{int(x), int(y), int(z)}, int(number / 4 % 3), int(number % 4)};
  }
  // Points, with corners and centers interleaved, so that their order is spatial.
  std::size_t point_count() const {
    return 2 * std::size_t(count[0] + 1) * std::size_t(count[1] + 1) * std::size_t(count[2] + 1);
  }
  std::size_t point_number(const Cube& c, bool center) const {
    const std::size_t corner =
        (std::size_t(c[2]) * std::size_t(count[1] + 1) + std::size_t(c[1])) * std::size_t(count[0] + 1) +
        std::size_t(c[0]);
    return 2 * corner + (center ? 1 : 0);
  }
};

struct LatticePoint {
  Cube cube;
  bool center;
  Vec3d position() const {
    const double half = center ? 0.5 : 0.0;
    return {cube[0] + half, cube[1] + half, cube[2] + half};
  }
};

Cube moved(Cube c, int axis, int by) {
  c[std::size_t(axis)] += by;
  return c;
}

// Positively oriented: center below, two corners counterclockwise about the axis, center above.
std::array<LatticePoint, 4> points_of(const TetId& t) {
  const int u = (t.axis + 1) % 3, v = (t.axis + 2) % 3;
  const Cube face[4] = {t.cube, moved(t.cube, u, 1), moved(moved(t.cube, u, 1), v, 1), moved(t.cube, v, 1)};
  return {{{moved(t.cube, t.axis, -1), true},
           {face[t.quadrant], false},
           {face[(t.quadrant + 1) % 4], false},
           {t.cube, true}}};
}

Points4 corners_of(const TetId& t) {
  const auto p = points_of(t);
  return {p[0].position(), p[1].position(), p[2].position(), p[3].position()};
}

// The quadrant of the face across `axis` on the low (-1) or high (+1) side along axis `towards`.
int quadrant_towards(int axis, int towards, int side) {
  if (towards == (axis + 1) % 3) return side > 0 ? 1 : 3;
  return side > 0 ? 2 : 0;
}

// The tet that contains q (in cubes), by the largest and second largest component of q's offset from the
// cube's center.
TetId locate(const Vec3d& q) {
  Cube cube{};
  Vec3d offset;
  for (int i = 0; i < 3; ++i) {
    cube[std::size_t(i)] = int(std::floor(q[i]));
    offset[i] = q[i] - std::floor(q[i]) - 0.5;
  }
  int axis = 0;
  for (int i = 1; i < 3; ++i)
    if (std::abs(offset[i]) > std::abs(offset[axis])) axis = i;
  const int u = (axis + 1) % 3, v = (axis + 2) % 3;
  const int second = std::abs(offset[u]) >= std::abs(offset[v]) ? u : v;
  const int quadrant = quadrant_towards(axis, second, offset[second] > 0 ? 1 : -1);
  return {offset[axis] > 0 ? moved(cube, axis, 1) : cube, axis, quadrant};
}

// The tets across the four faces of t.
std::array<TetId, 4> neighbors_of(const TetId& t) {
  constexpr int side_of_quadrant[4] = {-1, 1, 1, -1};  // low v, high u, high v, low u
  const int e = (t.axis + (t.quadrant % 2 == 1 ? 1 : 2)) % 3, side = side_of_quadrant[t.quadrant];
  // Within each of the two cubes, the neighbor is on the face toward (e, side), at the same edge of the cube.
  const auto beside = [&](const Cube& cube, int end) {
    return TetId{side > 0 ? moved(cube, e, 1) : cube, e, quadrant_towards(e, t.axis, end)};
  };
  return {{{t.cube, t.axis, (t.quadrant + 1) % 4},
           {t.cube, t.axis, (t.quadrant + 3) % 4},
           beside(t.cube, -1),
           beside(moved(t.cube, t.axis, -1), 1)}};
}

// Overlap depth of two convex bodies along `axis`; a negative depth is a gap. Unbounded if the axis has no
// length.
double depth_along(const Vec3d& axis, const Points4& tet, const Points3& triangle) {
  const double l = length(axis);
  if (!(l > 1e-12)) return std::numeric_limits<double>::infinity();
  double lo_a = dot(axis, tet[0]), hi_a = lo_a, lo_b = dot(axis, triangle[0]), hi_b = lo_b;
  for (std::size_t i = 1; i < 4; ++i) {
    lo_a = std::min(lo_a, dot(axis, tet[i]));
    hi_a = std::max(hi_a, dot(axis, tet[i]));
  }
  for (std::size_t i = 1; i < 3; ++i) {
    lo_b = std::min(lo_b, dot(axis, triangle[i]));
    hi_b = std::max(hi_b, dot(axis, triangle[i]));
  }
  return std::min(hi_a - lo_b, hi_b - lo_a) / l;
}

// Separating axes: the face normals of the tet, the normal of the triangle, and the cross products of edges.
Mark overlap(Points4 tet, Points3 triangle) {
  const Vec3d origin = tet[0];  // relative coordinates keep precision in a long lattice
  for (Vec3d& p : tet) p = p - origin;
  for (Vec3d& p : triangle) p = p - origin;
  double depth = std::numeric_limits<double>::infinity();
  const auto separated = [&](const Vec3d& axis) {
    depth = std::min(depth, depth_along(axis, tet, triangle));
    return depth < -contact;
  };
  const Vec3d tet_edges[6] = {tet[1] - tet[0], tet[2] - tet[0], tet[3] - tet[0],
                              tet[2] - tet[1], tet[3] - tet[1], tet[3] - tet[2]};
  constexpr int face[4][2] = {{0, 1}, {0, 2}, {1, 2}, {3, 4}};
  for (const auto& f : face)
    if (separated(cross(tet_edges[f[0]], tet_edges[f[1]]))) return clear;
  const Vec3d sides[3] = {triangle[1] - triangle[0], triangle[2] - triangle[1], triangle[0] - triangle[2]};
  if (separated(normalized(cross(sides[0], sides[1])))) return clear;
  for (const Vec3d& side : sides) {
    const Vec3d direction = normalized(side);
    for (const Vec3d& edge : tet_edges)
      if (separated(cross(edge, direction))) return clear;
  }
  return depth > contact ? crossed : touched;
}

// Whether a box and a triangle are apart along the triangle's normal, or along a cross product of one side of each.
// See Akenine-Moller 2001, classes 2 and 3. Lengths are in cubes; rounding finds no pair apart that meets.
bool apart(const BoundingBox& box, const Points3& triangle) {
  constexpr double rounding = 1e-6;
  const Vec3d center = box.center(), half = box.size() / 2;
  const Points3 p{triangle[0] - center, triangle[1] - center, triangle[2] - center};
  const auto separated = [&](const Vec3d& direction) {
    const Vec3d axis = normalized(direction);
    const double reach = std::abs(axis.x) * half.x + std::abs(axis.y) * half.y + std::abs(axis.z) * half.z;
    const auto [low, high] = std::minmax({dot(axis, p[0]), dot(axis, p[1]), dot(axis, p[2])});
    return low > reach + rounding || high < -reach - rounding;
  };
  const Vec3d sides[3] = {p[1] - p[0], p[2] - p[1], p[0] - p[2]};
  if (separated(cross(sides[0], sides[1]))) return true;
  for (const Vec3d& side : sides)
    for (const Vec3d& axis : {Vec3d(1, 0, 0), Vec3d(0, 1, 0), Vec3d(0, 0, 1)})
      if (separated(cross(axis, side))) return true;
  return false;
}

/// A surface in units of cubes, with the origin at the lattice's lower corner.
struct Scaled {
  std::vector<Vec3d> positions;
  const std::vector<Triangle>* triangles;
  LatticeIndex index;
  Vec3d origin;  // meters
  double cell_size;
};

class Marker {
 public:
  explicit Marker(const Scaled& surface) : surface_(surface), index_(surface.index) {}

  /// Marks the tets near the surface, and returns how many it crosses.
  std::size_t mark_surface() {
    marks_.assign(index_.tets(), clear);
    for (const Triangle& t : *surface_.triangles) mark_triangle(t);
    return std::size_t(std::count(marks_.begin(), marks_.end(), crossed));
  }

  /// Marks all others, after mark_surface().
  std::vector<std::uint8_t> mark_rest() {
    flood();
    classify_touched();
    // Rounding in the overlap test must not leave a vertex uncovered.
    for (const Triangle& t : *surface_.triangles)
      for (const std::uint32_t v : t) {
        std::uint8_t& mark = marks_[index_.number(locate(surface_.positions[v]))];
        if (mark == outside) mark = crossed;
      }
    return std::move(marks_);
  }

 private:
  void mark_triangle(const Triangle& t) {
    const Points3 p{surface_.positions[t[0]], surface_.positions[t[1]], surface_.positions[t[2]]};
    Vec3d lo, hi;
    for (int i = 0; i < 3; ++i) {
      lo[i] = std::min({p[0][i], p[1][i], p[2][i]}) - contact;
      hi[i] = std::max({p[0][i], p[1][i], p[2][i]}) + contact;
    }
    for (int axis = 0; axis < 3; ++axis) mark_along(axis, lo, hi, p);
  }

  // Tets of faces across `axis` whose boxes overlap the box lo..hi. They extend half a cube to both sides of the face,
  // and the face is inside its cube.
  void mark_along(int axis, const Vec3d& lo, const Vec3d& hi, const Points3& p) {
    Cube first{}, last{};
    for (int i = 0; i < 3; ++i) {
      first[std::size_t(i)] = int(i == axis ? std::ceil(lo[i] - 0.5) : std::floor(lo[i]));
      last[std::size_t(i)] = int(i == axis ? std::floor(hi[i] + 0.5) : std::floor(hi[i]));
    }
    mark_block(axis, first, last, lo, hi, p);
  }

  // Halves large blocks of faces until they are small or apart from the triangle: the box of a long, slanted triangle
  // is nearly empty.
  void mark_block(int axis, const Cube& first, const Cube& last, const Vec3d& lo, const Vec3d& hi,
                  const Points3& p) {
    constexpr std::int64_t small = 64;
    std::int64_t faces = 1;
    std::size_t longest = 0;
    for (std::size_t i = 0; i < 3; ++i) {
      if (last[i] < first[i]) return;
      faces *= last[i] - first[i] + 1;
      if (last[i] - first[i] > last[longest] - first[longest]) longest = i;
    }
    if (faces > small) {
      if (apart(block_of(axis, first, last), p)) return;
      Cube end = last, begin = first;
      end[longest] = first[longest] + (last[longest] - first[longest]) / 2;
      begin[longest] = end[longest] + 1;
      mark_block(axis, first, end, lo, hi, p);
      mark_block(axis, begin, last, lo, hi, p);
      return;
    }
    for (int z = first[2]; z <= last[2]; ++z)
      for (int y = first[1]; y <= last[1]; ++y)
        for (int x = first[0]; x <= last[0]; ++x)
          for (int quadrant = 0; quadrant < 4; ++quadrant) mark_tet({{x, y, z}, axis, quadrant}, lo, hi, p);
  }

  // The box of the tets of faces across `axis`.
  static BoundingBox block_of(int axis, const Cube& first, const Cube& last) {
    BoundingBox box;
    for (int i = 0; i < 3; ++i) {
      box.lo[i] = first[std::size_t(i)] - (i == axis ? 0.5 : 0.0);
      box.hi[i] = last[std::size_t(i)] + (i == axis ? 0.5 : 1.0);
    }
    return box;
  }

  void mark_tet(const TetId& id, const Vec3d& lo, const Vec3d& hi, const Points3& p) {
    std::uint8_t& mark = marks_[index_.number(id)];
    if (mark == crossed) return;
    const Points4 tet = corners_of(id);
    for (int i = 0; i < 3; ++i) {
      const auto [low, high] = std::minmax({tet[0][i], tet[1][i], tet[2][i], tet[3][i]});
      if (low > hi[i] || high < lo[i]) return;
    }
    mark = std::max(mark, std::uint8_t(overlap(tet, p)));
  }

  // Classifies each face-connected region of clear tets once.
  void flood() {
    std::vector<std::size_t> region;
    for (std::size_t seed = 0; seed < marks_.size(); ++seed) {
      if (marks_[seed] != clear || !index_.has(index_.tet(seed))) continue;
      bool at_rim = false;
      region.assign(1, seed);
      marks_[seed] = outside;
      for (std::size_t next = 0; next < region.size(); ++next)
        for (const TetId& n : neighbors_of(index_.tet(region[next]))) {
          if (!index_.has(n)) {
            at_rim = true;
          } else if (marks_[index_.number(n)] == clear) {
            marks_[index_.number(n)] = outside;
            region.push_back(index_.number(n));
          }
        }
      if (at_rim || !is_inside(seed)) continue;
      for (const std::size_t t : region) marks_[t] = inside;
    }
  }

  // Tets that the surface only touches are on one side of it. It is the side of a neighbor that the surface does not
  // touch, if there is one.
  void classify_touched() {
    std::vector<std::pair<std::size_t, Mark>> answers;
    for (std::size_t t = 0; t < marks_.size(); ++t)
      if (marks_[t] == touched) answers.push_back({t, side_of(t)});
    // Written last: side_of must see only sides from the flood fill.
    for (const auto& [t, answer] : answers) marks_[t] = answer;
  }

  Mark side_of(std::size_t tet) {
    for (const TetId& n : neighbors_of(index_.tet(tet))) {
      const std::uint8_t mark = marks_[index_.number(n)];
      if (mark == inside || mark == outside) return Mark(mark);
    }
    return is_inside(tet) ? inside : outside;
  }

  // By the winding number at the tet's center (Jacobson et al. 2013, eq. 5, with van Oosterom's solid angle):
  // 0 outside, 1 inside. After `budget_` triangles the answer is inside: an overfull body rather than one
  // with holes.
  bool is_inside(std::size_t tet) {
    if (budget_ < surface_.triangles->size()) return true;
    budget_ -= surface_.triangles->size();
    const Points4 corners = corners_of(index_.tet(tet));
    const Vec3d middle = (corners[0] + corners[1] + corners[2] + corners[3]) / 4;
    double sum = 0;
    for (const Triangle& t : *surface_.triangles) {
      const Vec3d a = surface_.positions[t[0]] - middle, b = surface_.positions[t[1]] - middle,
                  c = surface_.positions[t[2]] - middle;
      const double la = length(a), lb = length(b), lc = length(c);
      sum += 2 * elementary::atan2(dot(a, cross(b, c)),
                                   la * lb * lc + dot(a, b) * lc + dot(b, c) * la + dot(c, a) * lb);
    }
    return std::abs(sum) > 2 * pi;
  }

  const Scaled& surface_;
  const LatticeIndex& index_;
  std::vector<std::uint8_t> marks_;
  std::size_t budget_ = 100'000'000;
};

struct Solid {
  std::vector<Vec3d> positions;
  std::vector<Triangle> triangles;
  double volume, area;
  BoundingBox box;
};

double cubes_needed(const Solid& solid, double cell_size) {
  double product = 1;
  for (int i = 0; i < 3; ++i) product *= std::ceil(solid.box.size()[i] / cell_size) + 2 * margin;
  return product;
}

Scaled scaled(const Solid& solid, double cell_size) {
  Scaled s{{}, &solid.triangles, {}, {}, cell_size};
  for (int i = 0; i < 3; ++i) {
    const int cubes = int(std::ceil(solid.box.size()[i] / cell_size)) + 2 * margin;
    s.index.count[std::size_t(i)] = cubes;
    s.origin[i] = solid.box.center()[i] - cell_size * (double(cubes) / 2);
  }
  s.positions.reserve(solid.positions.size());
  for (const Vec3d& p : solid.positions) s.positions.push_back((p - s.origin) / cell_size);
  return s;
}

bool is_kept(std::uint8_t mark) {
  return mark == crossed || mark == inside;
}

Lattice assemble(const Scaled& surface, const std::vector<std::uint8_t>& marks) {
  const LatticeIndex& index = surface.index;
  constexpr std::uint32_t unused = ~std::uint32_t(0);
  std::vector<std::uint32_t> vertex(index.point_count(), unused);
  std::vector<std::size_t> kept;
  for (std::size_t t = 0; t < marks.size(); ++t) {
    if (!is_kept(marks[t])) continue;
    kept.push_back(t);
    for (const LatticePoint& p : points_of(index.tet(t))) vertex[index.point_number(p.cube, p.center)] = 0;
  }
  Lattice lattice;
  lattice.cell_size = surface.cell_size;
  const std::size_t row = std::size_t(index.count[0] + 1), layer = row * std::size_t(index.count[1] + 1);
  for (std::size_t n = 0; n < vertex.size(); ++n) {
    if (vertex[n] == unused) continue;
    vertex[n] = static_cast<std::uint32_t>(lattice.mesh.positions.size());
    const std::size_t corner = n / 2;
    const LatticePoint p{{int(corner % row), int(corner % layer / row), int(corner / layer)}, n % 2 == 1};
    lattice.mesh.positions.push_back(surface.origin + p.position() * surface.cell_size);
  }
  for (const std::size_t t : kept) {
    Tet tet{};
    const auto points = points_of(index.tet(t));
    for (std::size_t i = 0; i < 4; ++i) tet[i] = vertex[index.point_number(points[i].cube, points[i].center)];
    lattice.mesh.tets.push_back(tet);
    ++(marks[t] == crossed ? lattice.crossed : lattice.inner);
  }
  return lattice;
}

// Cell size at which a solid of this volume and area has about `target` tets. An inner cube has 12 tets. Around the
// surface lies half a cube's layer of tets, which extend about 0.3 cubes outside on average.
double guess_cell_size(const Solid& solid, double target) {
  double lo = solid.box.diagonal() * 1e-6, hi = solid.box.diagonal() * 4;
  for (int i = 0; i < 60; ++i) {
    const double a = std::sqrt(lo * hi),
                 count = 12 * (solid.volume / (a * a * a) + 0.3 * solid.area / (a * a));
    (count > target ? lo : hi) = a;
  }
  return hi;
}

/// The lattice, or one without tets if the surface alone crosses more than `most`; and its number of tets, or of
/// the crossed ones.
std::pair<Lattice, std::size_t> lattice_of_at_most(const Solid& solid, double cell_size, std::size_t most) {
  const Scaled surface = scaled(solid, cell_size);
  Marker marker(surface);
  const std::size_t crossings = marker.mark_surface();
  if (crossings > most) return {Lattice{}, crossings};
  Lattice lattice = assemble(surface, marker.mark_rest());
  const std::size_t count = lattice.mesh.tets.size();
  return {std::move(lattice), count};
}

Lattice lattice_of_size(const Solid& solid, double cell_size) {
  return lattice_of_at_most(solid, cell_size, std::numeric_limits<std::size_t>::max()).first;
}

// Tries at most eight sizes until the count is within 5 % of the target; the nearest count wins. A size that is far
// too fine is not completed, which would take most of the time, unless it is the last one.
Lattice lattice_of_count(const Solid& solid, int target) {
  constexpr int attempts = 8;
  const std::size_t far = std::size_t(target) * 4;
  double cell_size = guess_cell_size(solid, target), too_fine = 0, too_coarse = 0, best_miss = 0,
         last_ratio = 0;
  Lattice best;
  for (int attempt = 0; attempt < attempts; ++attempt) {
    double ratio = 4;  // count over target
    // The count scales with the size to the power -2 (thin) to -3 (thick), for a wire -1. The second of two tries that
    // is still more than twice too fine shows which.
    double power = 0.4;
    if (cubes_needed(solid, cell_size) <= max_cubes) {
      auto [lattice, count] = lattice_of_at_most(
          solid, cell_size, attempt + 1 < attempts ? far : std::numeric_limits<std::size_t>::max());
      ratio = double(count) / double(target);
      const double miss = std::abs(elementary::log(ratio));
      if (!lattice.mesh.tets.empty() && (best.mesh.tets.empty() || miss < best_miss)) {
        best = std::move(lattice);
        best_miss = miss;
      }
      if (miss < 0.05) break;
      if (last_ratio > ratio && ratio > 2)
        power =
            std::clamp(elementary::log(cell_size / too_fine) / elementary::log(last_ratio / ratio), 0.4, 1.0);
      last_ratio = ratio;
    }
    (ratio > 1 ? too_fine : too_coarse) = cell_size;
    // The next size stays between tried ones. Rounded to a float, because the last bit of pow differs between C
    // libraries.
    cell_size *= double(float(elementary::pow(ratio, power)));
    if (too_fine > 0 && too_coarse > 0 && !(cell_size > too_fine && cell_size < too_coarse))
      cell_size = (too_fine + too_coarse) / 2;
  }
  return best;
}

Solid solid_of(const TriangleMesh& mesh, const std::string& name, std::vector<std::string>& sentences) {
  ClosedSurface closed = closed_surface(mesh, name);
  sentences = closed.sentences();
  Solid solid{std::move(closed.mesh.positions), std::move(closed.mesh.triangles), 0, 0, {}};
  solid.volume = std::abs(enclosed_volume(solid.positions, solid.triangles));
  solid.area = surface_area(solid.positions, solid.triangles);
  // An unused vertex must not enlarge the lattice.
  solid.box = bounding_box(solid.positions, solid.triangles);
  const double diagonal = solid.box.diagonal();
  if (!(solid.volume > 1e-15 * diagonal * diagonal * diagonal) || !std::isfinite(solid.volume))
    throw Error(
        fmt::format("{}: the surface encloses no volume ({:.3g} m^3); a soft body needs a solid shape", name,
                    solid.volume));
  return solid;
}

void check_options(const LatticeOptions& options, const std::string& name) {
  const bool size = options.cell_size != 0, count = options.cells != 0;
  if (size == count)
    throw Error(name + ": a lattice needs either a cell size or a number of tets, " +
                (size ? "and has both" : "and has neither"));
  if (size && !(std::isfinite(options.cell_size) && options.cell_size > 0))
    throw Error(fmt::format("{}: the lattice's cell size is {:.3g}, expected a positive length in meters",
                            name, options.cell_size));
  if (count && options.cells > 10'000'000)
    throw Error(
        fmt::format("{}: the lattice's number of tets is {}, expected 1 to 10000000", name, options.cells));
}

}  // namespace

Lattice build_lattice(const TriangleMesh& mesh, const LatticeOptions& options, const std::string& name) {
  check_options(options, name);
  std::vector<std::string> sentences;
  const Solid solid = solid_of(mesh, name, sentences);
  const double cubes = options.cell_size > 0 ? cubes_needed(solid, options.cell_size) : 0;
  if (cubes > max_cubes)
    throw Error(
        fmt::format("{}: a lattice of {:.3g} m cells needs {:.3g} cubes, more than 4 million; the surface is "
                    "{:.3g} m across: use larger cells, or check the unit of the file",
                    name, options.cell_size, cubes, solid.box.diagonal()));
  Lattice lattice = options.cell_size > 0 ? lattice_of_size(solid, options.cell_size)
                                          : lattice_of_count(solid, static_cast<int>(options.cells));
  if (lattice.mesh.tets.empty())
    throw Error(fmt::format("{}: a lattice of {} tets is too fine for this surface; use fewer tets", name,
                            options.cells));
  lattice.sentences = std::move(sentences);
  lattice.surface_volume = solid.volume;
  lattice.lattice_volume = tet_volume(lattice.mesh);
  lattice.pieces =
      connected_components(std::span<const Tet>(lattice.mesh.tets), lattice.mesh.positions.size()).count;
  return lattice;
}

}  // namespace souple
