#include "souple/geometry/hull_faces.h"

#include "souple/geometry/measures.h"
#include "souple/math/lists.h"
#include "souple/math/sentinels.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

namespace souple {
namespace {

using Indices = std::vector<std::uint32_t>;

struct Plane {
  Vec3d normal;  // unit
  Vec3d point;   // on it
};

// The plane through the mean of the corners; its normal is that of least squares of the projected area (Newell):
//   n = sum (x_i - c) x (x_(i+1) - c)
Plane plane_of(std::span<const Vec3d> positions, const Indices& loop) {
  Plane plane;
  for (const std::uint32_t v : loop) plane.point += positions[v] / double(loop.size());
  for (std::size_t i = 0; i < loop.size(); ++i)
    plane.normal +=
        cross(positions[loop[i]] - plane.point, positions[loop[(i + 1) % loop.size()]] - plane.point);
  plane.normal = normalized(plane.normal);
  return plane;
}

// Distance of v from the line through a and b; at least from a or b where v lies beyond them.
double distance_to_segment(const Vec3d& v, const Vec3d& a, const Vec3d& b) {
  const Vec3d ab = b - a;
  const double square = length_squared(ab);
  const double t = square > 0 ? std::clamp(dot(v - a, ab) / square, 0.0, 1.0) : 0.0;
  return length(v - (a + ab * t));
}

// How triangles are joined: within the tolerance, within rounding, not at all.
enum Level : std::uint8_t { coplanar, exactly_coplanar, separate };

class FaceMerger {
 public:
  FaceMerger(std::span<const Vec3d> positions, const HullTriangles& hull, double tolerance)
      : x_(positions),
        hull_(hull),
        vertex_neighbors_(positions.size(),
                          [&](const auto& add) {
                            for (const Triangle& t : hull.triangles)
                              for (std::size_t i = 0; i < 3; ++i) add(t[i], t[(i + 1) % 3]);
                          }),
        tolerance_(tolerance),
        rounding_(1e-15 * bounding_box(positions).diagonal()) {
    level_.assign(hull.triangles.size(), coplanar);
    seeds_ = seeds_by_area();
    vertex_mark_.assign(positions.size(), 0);
    following_.assign(positions.size(), no_index);
    beyond_.assign(positions.size(), no_index);
  }

  HullPolygons merge();

 private:
  double tolerance(Level level) const { return level == coplanar ? tolerance_ : tolerance_ * 1e-4; }
  Indices seeds_by_area() const;
  void start_group(std::uint32_t seed);
  void grow(std::uint32_t seed, const Plane& plane, Level level);
  bool fits(std::uint32_t triangle, const Plane& plane, Level level) const;
  bool keeps_disk(std::uint32_t triangle) const;
  void join(std::uint32_t triangle);
  void dissolve();
  void trace_loop();
  bool is_convex(const Vec3d& normal, Level level) const;
  bool merge_around(std::uint32_t seed, Level level);
  void take_single(std::uint32_t seed);
  void finish_group(const Vec3d& normal, Level level);
  void group_triangles();
  void drop_straight_corners();
  void mark_flat_corners(std::vector<char>& bad) const;
  void mark_shared_diagonals(std::vector<char>& bad) const;
  void mark_tilted(std::vector<char>& bad) const;
  bool separate_degenerate();
  double support(const Vec3d& n, std::uint32_t start) const;
  bool is_straight(const Indices& loop, std::size_t first, std::size_t last) const;

  std::span<const Vec3d> x_;
  const HullTriangles& hull_;
  Lists<std::uint32_t> vertex_neighbors_;  // per vertex: those joined to it by a side of a triangle
  double tolerance_, rounding_;
  Indices seeds_;
  std::vector<Level> level_;  // per triangle: the loosest that it takes part in
  std::vector<HullPolygon> polygons_;
  std::vector<Level> polygon_level_;
  Indices group_;  // per triangle: its polygon, or none yet
  // The group that grows, polygon `current_`.
  std::uint32_t current_{0};
  Indices members_, waiting_;
  Indices loop_, loop_across_;  // its outline, and the triangle beyond each edge
  Indices vertex_mark_;         // per vertex: mark_ if a member has it
  std::uint32_t mark_{0};
  Indices following_,
      beyond_;  // per vertex of the outline: the next one, and the triangle beyond the edge to it
};

// The largest first; equal ones in order.
Indices FaceMerger::seeds_by_area() const {
  std::vector<double> area;
  area.reserve(hull_.triangles.size());
  for (const auto& [a, b, c] : hull_.triangles) area.push_back(length(cross(x_[b] - x_[a], x_[c] - x_[a])));
  Indices seeds(hull_.triangles.size());
  std::iota(seeds.begin(), seeds.end(), 0u);
  std::stable_sort(seeds.begin(), seeds.end(),
                   [&](std::uint32_t s, std::uint32_t t) { return area[s] > area[t]; });
  return seeds;
}

// A triangle that is turned by more than 60 degrees belongs to another side of a thin hull, however near its corners are.
bool FaceMerger::fits(std::uint32_t triangle, const Plane& plane, Level level) const {
  if (group_[triangle] != no_index || level_[triangle] > level) return false;
  if (dot(hull_.normals[triangle], plane.normal) < 0.5) return false;
  for (const std::uint32_t v : hull_.triangles[triangle])
    if (std::abs(dot(plane.normal, x_[v] - plane.point)) > tolerance(level)) return false;
  return true;
}

// Whether the group with this triangle is still a disk. The triangle must join along one side and bring a new vertex,
// or fill a corner between two sides.
bool FaceMerger::keeps_disk(std::uint32_t triangle) const {
  std::uint32_t shared = 0, opposite = no_index;
  for (std::size_t side = 0; side < 3; ++side)
    if (group_[hull_.neighbors[triangle][side]] == current_) {
      ++shared;
      opposite = hull_.triangles[triangle][(side + 2) % 3];
    }
  return shared == 2 || (shared == 1 && vertex_mark_[opposite] != mark_);
}

void FaceMerger::join(std::uint32_t triangle) {
  group_[triangle] = current_;
  members_.push_back(triangle);
  for (const std::uint32_t v : hull_.triangles[triangle]) vertex_mark_[v] = mark_;
  for (const std::uint32_t other : hull_.neighbors[triangle]) waiting_.push_back(other);
}

void FaceMerger::start_group(std::uint32_t seed) {
  members_.clear();
  waiting_.clear();
  ++mark_;
  join(seed);
}

void FaceMerger::grow(std::uint32_t seed, const Plane& plane, Level level) {
  start_group(seed);
  for (std::size_t i = 0; i < waiting_.size(); ++i) {
    const std::uint32_t t = waiting_[i];
    if (fits(t, plane, level) && keeps_disk(t)) join(t);
  }
}

void FaceMerger::dissolve() {
  for (const std::uint32_t t : members_) group_[t] = no_index;
}

// The outline of the group from its lowest vertex.
void FaceMerger::trace_loop() {
  std::uint32_t start = no_index;
  for (const std::uint32_t t : members_)
    for (std::size_t side = 0; side < 3; ++side) {
      if (group_[hull_.neighbors[t][side]] == current_) continue;
      const std::uint32_t from = hull_.triangles[t][side];
      following_[from] = hull_.triangles[t][(side + 1) % 3];
      beyond_[from] = hull_.neighbors[t][side];
      start = std::min(start, from);
    }
  loop_.clear();
  loop_across_.clear();
  std::uint32_t v = start;
  do {
    loop_.push_back(v);
    loop_across_.push_back(beyond_[v]);
    v = following_[v];
  } while (v != start);
}

// Whether no corner v between u and w lies deeper inside than the tolerance, seen along the normal:
//   depth = n . ((w - v) x (v - u)) / |w - u|, negative at a convex corner
bool FaceMerger::is_convex(const Vec3d& normal, Level level) const {
  const std::size_t count = loop_.size();
  for (std::size_t i = 0; i < count; ++i) {
    const Vec3d &u = x_[loop_[i]], &v = x_[loop_[(i + 1) % count]], &w = x_[loop_[(i + 2) % count]];
    const double turn = dot(normal, cross(v - u, w - v));
    if (turn > 0) continue;
    if (-turn > tolerance(level) * length(w - u) || dot(v - u, w - v) <= 0) return false;
  }
  return true;
}

// The plane of the seed is corrected to that of the outline until the group stays the same: a sliver is tilted.
bool FaceMerger::merge_around(std::uint32_t seed, Level level) {
  constexpr int corrections = 4;
  const Triangle& t = hull_.triangles[seed];
  Plane plane{hull_.normals[seed], (x_[t[0]] + x_[t[1]] + x_[t[2]]) / 3.0};
  grow(seed, plane, level);
  std::size_t before = 1;
  for (int i = 0; i < corrections && members_.size() != before; ++i) {
    before = members_.size();
    trace_loop();
    plane = plane_of(x_, loop_);
    dissolve();
    grow(seed, plane, level);
  }
  trace_loop();
  if (members_.size() > 1 && is_convex(plane.normal, level)) return true;
  dissolve();
  return false;
}

void FaceMerger::take_single(std::uint32_t seed) {
  start_group(seed);
  trace_loop();
}

// The largest n . x of the hull, by steps to higher neighbors: on a convex surface, what has none is the highest. Steps within
// rounding do not count, because a vertex may have very many neighbors.
double FaceMerger::support(const Vec3d& n, std::uint32_t start) const {
  std::uint32_t best = start;
  double height = dot(n, x_[best]);
  for (bool higher = true; higher;) {
    higher = false;
    for (const std::uint32_t v : vertex_neighbors_[best]) {
      const double h = dot(n, x_[v]);
      if (!(h > height + rounding_)) continue;
      best = v;
      height = h;
      higher = true;
      break;
    }
  }
  return height;
}

void FaceMerger::finish_group(const Vec3d& normal, Level level) {
  polygons_.push_back({normal, support(normal, loop_[0]), loop_, loop_across_});
  polygon_level_.push_back(level);
  ++current_;
}

// Whether the corners between two of a loop lie on a line. Both polygons at an edge compute with the same bits.
bool FaceMerger::is_straight(const Indices& loop, std::size_t first, std::size_t last) const {
  const std::size_t n = loop.size();
  const auto [a, b] = std::minmax(loop[first % n], loop[last % n]);
  for (std::size_t i = first + 1; i < last; ++i)
    if (distance_to_segment(x_[loop[i % n]], x_[a], x_[b]) > tolerance_) return false;
  return true;
}

// A vertex of only two polygons lies on the edge between them. The vertices of an edge are dropped together if they are
// on a line between its ends. Both polygons must have at least three vertices of three or more polygons.
void FaceMerger::drop_straight_corners() {
  Indices uses(x_.size(), 0);
  for (const HullPolygon& p : polygons_)
    for (const std::uint32_t v : p.corners) ++uses[v];
  const auto is_end = [&](std::uint32_t v) { return uses[v] > 2; };
  std::vector<std::size_t> ends;
  for (const HullPolygon& p : polygons_)
    ends.push_back(std::size_t(std::count_if(p.corners.begin(), p.corners.end(), is_end)));
  for (std::size_t f = 0; f < polygons_.size(); ++f) {
    HullPolygon& p = polygons_[f];
    const std::size_t n = p.corners.size();
    if (ends[f] < 3) continue;
    const HullPolygon old = p;
    p.corners.clear();
    p.across.clear();
    const auto begin =
        std::size_t(std::find_if(old.corners.begin(), old.corners.end(), is_end) - old.corners.begin());
    for (std::size_t first = begin; first < begin + n;) {
      std::size_t last = first + 1;
      while (!is_end(old.corners[last % n])) ++last;
      const std::uint32_t other = old.across[first % n];
      const bool straight = ends[other] >= 3 && is_straight(old.corners, first, last);
      for (std::size_t i = first; i < (straight ? first + 1 : last); ++i) {
        p.corners.push_back(old.corners[i % n]);
        p.across.push_back(other);
      }
      first = last;
    }
  }
}

// Where a hull is hardly thicker than the tolerance, its two sides may meet at a corner that no third polygon has.
void FaceMerger::mark_flat_corners(std::vector<char>& bad) const {
  Indices uses(x_.size(), 0);
  for (const HullPolygon& p : polygons_)
    for (const std::uint32_t v : p.corners) ++uses[v];
  for (std::size_t f = 0; f < polygons_.size(); ++f)
    for (const std::uint32_t v : polygons_[f].corners) bad[f] = bad[f] || uses[v] < 3;
}

// There, too, two polygons may have more in common than an edge, so that their triangles share a diagonal.
void FaceMerger::mark_shared_diagonals(std::vector<char>& bad) const {
  std::vector<char> has_diagonal(x_.size(), 0);
  for (const HullPolygon& p : polygons_)
    for (std::size_t i = 2; i + 1 < p.corners.size(); ++i)
      has_diagonal[p.corners[0]] = has_diagonal[p.corners[i]] = 1;
  struct Side {
    std::uint32_t low, high, polygon;
    bool operator<(const Side& b) const { return low != b.low ? low < b.low : high < b.high; }
  };
  std::vector<Side>
      sides;  // of triangles: each once for an edge of two polygons, twice for a diagonal of one
  for (std::uint32_t f = 0; f < polygons_.size(); ++f) {
    const Indices& loop = polygons_[f].corners;
    const auto add = [&](std::uint32_t a, std::uint32_t b, std::size_t times) {
      if (has_diagonal[a] && has_diagonal[b])
        sides.insert(sides.end(), times, {std::min(a, b), std::max(a, b), f});
    };
    for (std::size_t i = 0; i < loop.size(); ++i) add(loop[i], loop[(i + 1) % loop.size()], 1);
    for (std::size_t i = 2; i + 1 < loop.size(); ++i) add(loop[0], loop[i], 2);
  }
  std::sort(sides.begin(), sides.end());
  for (std::size_t first = 0, last = 0; first < sides.size(); first = last) {
    while (last < sides.size() && !(sides[first] < sides[last])) ++last;
    for (std::size_t s = first; s < last; ++s)
      if (last - first > 2) bad[sides[s].polygon] = 1;
  }
}

// A narrow group may be tilted about its length so far that its plane touches the hull elsewhere.
void FaceMerger::mark_tilted(std::vector<char>& bad) const {
  for (std::size_t f = 0; f < polygons_.size(); ++f)
    for (const std::uint32_t v : polygons_[f].corners)
      bad[f] = bad[f] || polygons_[f].offset - dot(polygons_[f].normal, x_[v]) > 3 * tolerance_;
}

// Triangles of polygons that cannot be faces are joined within less. Returns whether there are any.
bool FaceMerger::separate_degenerate() {
  if (polygons_.size() == hull_.triangles.size()) return false;
  std::vector<char> bad(polygons_.size(), 0);
  mark_flat_corners(bad);
  mark_shared_diagonals(bad);
  mark_tilted(bad);
  bool any = false;
  for (std::size_t t = 0; t < level_.size(); ++t) {
    const std::uint32_t f = group_[t];
    if (bad[f] == 0 || polygon_level_[f] == separate) continue;
    level_[t] = polygon_level_[f] == coplanar ? exactly_coplanar : separate;
    any = true;
  }
  return any;
}

void FaceMerger::group_triangles() {
  polygons_.clear();
  polygon_level_.clear();
  current_ = 0;
  group_.assign(hull_.triangles.size(), no_index);
  for (const std::uint32_t seed : seeds_) {
    if (group_[seed] != no_index) continue;
    Level level = level_[seed];
    while (level != separate && !merge_around(seed, level))
      level = level == coplanar && members_.size() > 1 ? exactly_coplanar : separate;
    if (level == separate) take_single(seed);
    finish_group(level == separate ? hull_.normals[seed] : plane_of(x_, loop_).normal, level);
  }
  for (HullPolygon& p : polygons_)
    for (std::uint32_t& across : p.across) across = group_[across];
}

HullPolygons FaceMerger::merge() {
  do {
    group_triangles();
    drop_straight_corners();
  } while (separate_degenerate());
  return {std::move(polygons_), std::move(group_)};
}

}  // namespace

HullPolygons merge_coplanar(std::span<const Vec3d> positions, const HullTriangles& hull, double tolerance) {
  return FaceMerger(positions, hull, tolerance).merge();
}

}  // namespace souple
