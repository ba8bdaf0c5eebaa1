#include "souple/geometry/quickhull.h"

#include "souple/assert.h"
#include "souple/math/sentinels.h"

#include <algorithm>
#include <cmath>
#include <queue>
#include <tuple>

namespace souple {
namespace {

__extension__ using Wide = __int128;  // standard C++ has no integer of this size

// n = (b - a) x (c - a), exact: components below 2^(2 grid_bits + 1).
Vec3<Wide> exact_normal(const GridPoint& a, const GridPoint& b, const GridPoint& c) {
  return cross(Vec3<Wide>(b - a), Vec3<Wide>(c - a));
}

// The unit normal; each component of n is rounded once, so that the normal of a sliver is as good as any other.
Vec3d unit_normal_of(const GridPoint& a, const GridPoint& b, const GridPoint& c) {
  return normalized(Vec3d(exact_normal(a, b, c)));
}

// The point with the largest value of `measure`, the first of equal ones.
template <class Measure>
std::uint32_t farthest_by(std::span<const GridPoint> points, const Measure& measure) {
  std::uint32_t best = 0;
  double best_value = measure(points[0]);
  for (std::uint32_t i = 1; i < points.size(); ++i) {
    const double value = measure(points[i]);
    if (value > best_value) {
      best = i;
      best_value = value;
    }
  }
  return best;
}

// The first point and the last one along the axis of the largest extent.
std::array<std::uint32_t, 2> farthest_pair(std::span<const GridPoint> points) {
  std::array<std::uint32_t, 2> pair{};
  std::int64_t extent = -1;
  for (int axis = 0; axis < 3; ++axis) {
    const auto lower = [&](const GridPoint& a, const GridPoint& b) { return a[axis] < b[axis]; };
    const auto low = std::min_element(points.begin(), points.end(), lower);
    const auto high = std::max_element(points.begin(), points.end(), lower);
    if ((*high)[axis] - (*low)[axis] <= extent) continue;
    extent = (*high)[axis] - (*low)[axis];
    pair = {static_cast<std::uint32_t>(low - points.begin()),
            static_cast<std::uint32_t>(high - points.begin())};
  }
  return pair;
}

}  // namespace

Simplex find_simplex(std::span<const GridPoint> points, double tolerance) {
  const auto [a, b] = farthest_pair(points);
  const GridPoint &pa = points[a], &pb = points[b];
  const double length_ab = length(Vec3d(pb - pa));
  if (length_ab <= tolerance) return {{a}, 1};

  const auto from_line = [&](const GridPoint& p) {
    return length(Vec3d(exact_normal(pa, pb, p))) / length_ab;
  };
  const std::uint32_t c = farthest_by(points, from_line);
  if (from_line(points[c]) <= tolerance) return {{a, b}, 2};

  const Vec3d normal = unit_normal_of(pa, pb, points[c]);
  const auto from_plane = [&](const GridPoint& p) { return std::abs(dot(normal, Vec3d(p - pa))); };
  const std::uint32_t d = farthest_by(points, from_plane);
  if (from_plane(points[d]) <= tolerance) return {{a, b, c}, 3};
  return {{a, b, c, d}, 4};
}

namespace {

struct Face {
  Triangle corners;
  Triangle neighbors;
  Vec3d normal;                   // unit
  std::uint32_t first{no_index};  // of the points above it, a list
  std::uint32_t farthest{no_index};
  double height{0};       // of the farthest
  std::uint32_t mark{0};  // of the last search that reached it
  bool removed{false};
};

// A side of a face that stays, seen from the face beyond it, which is removed: from a to b.
struct HorizonEdge {
  std::uint32_t a, b, kept, side;
};

class Hull {
 public:
  Hull(std::span<const GridPoint> points, double tolerance) : points_(points), tolerance_(tolerance) {
    next_.assign(points.size(), no_index);
    face_from_.assign(points.size(), no_index);
  }

  void start(const Simplex& simplex);
  /// Adds points while any is farther outside than the tolerance, up to the number of vertices.
  void grow(std::size_t max_vertices);
  HullTriangles result() const;

 private:
  struct Candidate {
    double height;
    std::uint32_t point, face;
    // The greatest is the next to be added.
    friend bool operator<(const Candidate& a, const Candidate& b) {
      return std::tie(a.height, b.point, b.face) < std::tie(b.height, a.point, a.face);
    }
  };

  std::uint32_t add_face(std::uint32_t a, std::uint32_t b, std::uint32_t c);
  double height(const Face& face, std::uint32_t point) const {
    return dot(face.normal, Vec3d(points_[point] - points_[face.corners[0]]));
  }
  bool is_above(const Face& face, std::uint32_t point, double height) const;
  void put_above(std::uint32_t face, std::uint32_t point, double height);
  void assign(std::uint32_t point, std::span<const std::uint32_t> faces);
  void offer(std::uint32_t face);
  void add_point(std::uint32_t face);
  void find_horizon(std::uint32_t face, std::uint32_t point);
  void build_cone(std::uint32_t point);
  void take_points(std::uint32_t face, std::vector<std::uint32_t>& points);
  std::uint32_t highest_face(std::uint32_t start, std::uint32_t point);
  bool assign_to_highest();

  std::span<const GridPoint> points_;
  double tolerance_;
  std::vector<Face> faces_;
  std::vector<std::uint32_t> free_;  // removed faces, for reuse
  std::vector<std::uint32_t> next_;  // per point: the next above the same face
  std::priority_queue<Candidate> queue_;
  std::uint32_t mark_{0};
  // Lists for the point that is being added, kept to reuse their memory.
  std::vector<std::uint32_t> visible_, cone_, orphans_;
  std::vector<HorizonEdge> horizon_;
  std::vector<std::uint32_t> face_from_;  // per vertex on the horizon: the new face whose first corner it is
};

std::uint32_t Hull::add_face(std::uint32_t a, std::uint32_t b, std::uint32_t c) {
  std::uint32_t index = static_cast<std::uint32_t>(faces_.size());
  if (free_.empty()) {
    faces_.emplace_back();
  } else {
    index = free_.back();
    free_.pop_back();
  }
  faces_[index] = {
      {a, b, c}, {no_index, no_index, no_index}, unit_normal_of(points_[a], points_[b], points_[c])};
  return index;
}

// Rounding of `height` is below 2^-10: a unit normal's is below 2^-51, distances are below 2^41. Nearer to the plane than
// 2^-8, integers decide.
bool Hull::is_above(const Face& face, std::uint32_t point, double height) const {
  constexpr double certain = 1.0 / 256;
  if (std::abs(height) > certain) return height > 0;
  const auto [a, b, c] = face.corners;
  const Vec3<Wide> n = exact_normal(points_[a], points_[b], points_[c]);
  return dot(n, Vec3<Wide>(points_[point] - points_[a])) > 0;
}

void Hull::put_above(std::uint32_t face, std::uint32_t point, double height) {
  Face& f = faces_[face];
  next_[point] = f.first;
  f.first = point;
  const bool farther = height > f.height || (height == f.height && point < f.farthest);
  if (f.farthest != no_index && !farther) return;
  f.farthest = point;
  f.height = height;
}

// A point that is above none of the new faces is inside from now on. It was above a removed face. If it is above a face
// that stays, it is also above a face between the two. The normal of a new face is a positive combination of those that
// met at its edge.
void Hull::assign(std::uint32_t point, std::span<const std::uint32_t> faces) {
  std::uint32_t best = no_index;
  double best_height = 0;
  for (const std::uint32_t f : faces) {
    const double h = height(faces_[f], point);
    if ((best != no_index && h <= best_height) || !is_above(faces_[f], point, h)) continue;
    best = f;
    best_height = h;
  }
  if (best != no_index) put_above(best, point, best_height);
}

void Hull::offer(std::uint32_t face) {
  const Face& f = faces_[face];
  if (f.farthest != no_index && f.height > tolerance_) queue_.push({f.height, f.farthest, face});
}

void Hull::start(const Simplex& simplex) {
  auto [a, b, c, d] = simplex.corners;
  const Vec3<Wide> n = exact_normal(points_[a], points_[b], points_[c]);
  if (dot(n, Vec3<Wide>(points_[d] - points_[a])) > 0) std::swap(b, c);
  for (const Triangle& t : {Triangle{a, b, c}, Triangle{b, a, d}, Triangle{c, b, d}, Triangle{a, c, d}})
    cone_.push_back(add_face(t[0], t[1], t[2]));
  const Triangle neighbors[4] = {{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}};
  for (std::uint32_t f = 0; f < 4; ++f) faces_[f].neighbors = neighbors[f];
  for (std::uint32_t p = 0; p < points_.size(); ++p) assign(p, cone_);
  for (const std::uint32_t f : cone_) offer(f);
}

// Faces that the point is above, and the edges between them and the others.
void Hull::find_horizon(std::uint32_t face, std::uint32_t point) {
  visible_.assign(1, face);
  horizon_.clear();
  faces_[face].mark = ++mark_;
  for (std::size_t i = 0; i < visible_.size(); ++i) {
    const Face f = faces_[visible_[i]];
    for (std::uint32_t side = 0; side < 3; ++side) {
      const std::uint32_t other = f.neighbors[side];
      Face& neighbor = faces_[other];
      if (neighbor.mark == mark_) continue;
      if (is_above(neighbor, point, height(neighbor, point))) {
        neighbor.mark = mark_;
        visible_.push_back(other);
      } else {
        const auto at = std::find(neighbor.neighbors.begin(), neighbor.neighbors.end(), visible_[i]);
        horizon_.push_back({f.corners[side], f.corners[(side + 1) % 3], other,
                            static_cast<std::uint32_t>(at - neighbor.neighbors.begin())});
      }
    }
  }
}

// A face from each edge of the horizon to the point: (a, b, point).
void Hull::build_cone(std::uint32_t point) {
  cone_.clear();
  for (const HorizonEdge& e : horizon_) {
    const std::uint32_t face = add_face(e.a, e.b, point);
    faces_[face].neighbors[0] = e.kept;
    faces_[e.kept].neighbors[e.side] = face;
    SOUPLE_ASSERT(face_from_[e.a] == no_index, "a horizon passes through a vertex once");
    face_from_[e.a] = face;
    cone_.push_back(face);
  }
  for (const std::uint32_t face : cone_) {
    const std::uint32_t following = face_from_[faces_[face].corners[1]];
    SOUPLE_ASSERT(following != no_index, "a horizon is closed");
    faces_[face].neighbors[1] = following;
    faces_[following].neighbors[2] = face;
  }
  for (const HorizonEdge& e : horizon_) face_from_[e.a] = no_index;
}

// Empties a face's list into `points`.
void Hull::take_points(std::uint32_t face, std::vector<std::uint32_t>& points) {
  Face& f = faces_[face];
  for (std::uint32_t p = f.first; p != no_index; p = next_[p]) points.push_back(p);
  f.first = f.farthest = no_index;
  f.height = 0;
}

void Hull::add_point(std::uint32_t face) {
  const std::uint32_t point = faces_[face].farthest;
  find_horizon(face, point);
  orphans_.clear();
  for (const std::uint32_t f : visible_) {
    take_points(f, orphans_);
    faces_[f].removed = true;
  }
  build_cone(point);
  // Only now, so that no new face has the index of one that the horizon names.
  free_.insert(free_.end(), visible_.rbegin(), visible_.rend());
  for (const std::uint32_t p : orphans_)
    if (p != point) assign(p, cone_);
  for (const std::uint32_t f : cone_) offer(f);
}

// Among the faces that the point is above, which are connected, the one that it is highest above.
std::uint32_t Hull::highest_face(std::uint32_t start, std::uint32_t point) {
  visible_.assign(1, start);
  faces_[start].mark = ++mark_;
  std::uint32_t best = start;
  double best_height = height(faces_[start], point);
  for (std::size_t i = 0; i < visible_.size(); ++i)
    for (const std::uint32_t other : faces_[visible_[i]].neighbors) {
      Face& f = faces_[other];
      if (f.mark == mark_) continue;
      f.mark = mark_;
      const double h = height(f, point);
      if (!is_above(f, point, h)) continue;
      visible_.push_back(other);
      if (h > best_height) {
        best = other;
        best_height = h;
      }
    }
  return best;
}

// A point was assigned to the highest of the faces that were new then. Now each point goes to the highest of all. Returns
// whether any is farther outside than the tolerance.
bool Hull::assign_to_highest() {
  struct Place {
    std::uint32_t point, face;
  };
  std::vector<Place> places;
  for (std::uint32_t f = 0; f < faces_.size(); ++f) {
    if (faces_[f].removed) continue;
    orphans_.clear();
    take_points(f, orphans_);
    for (const std::uint32_t p : orphans_) places.push_back({p, highest_face(f, p)});
  }
  for (const auto& [point, face] : places) put_above(face, point, height(faces_[face], point));
  for (std::uint32_t f = 0; f < faces_.size(); ++f)
    if (!faces_[f].removed) offer(f);
  return !queue_.empty();
}

void Hull::grow(std::size_t max_vertices) {
  std::size_t vertices = 4;
  do {
    while (!queue_.empty() && vertices < max_vertices) {
      const Candidate best = queue_.top();
      queue_.pop();
      const Face& face = faces_[best.face];
      // The face may be another one by now.
      if (face.removed || face.farthest != best.point || face.height != best.height) continue;
      add_point(best.face);
      ++vertices;
    }
    queue_ = {};
  } while (assign_to_highest() && vertices < max_vertices);
}

HullTriangles Hull::result() const {
  HullTriangles out;
  std::vector<std::uint32_t> number(faces_.size(), no_index);
  for (std::uint32_t f = 0, count = 0; f < faces_.size(); ++f)
    if (!faces_[f].removed) number[f] = count++;
  for (std::uint32_t f = 0; f < faces_.size(); ++f) {
    const Face& face = faces_[f];
    if (face.removed) continue;
    out.triangles.push_back(face.corners);
    const auto [i, j, k] = face.neighbors;
    out.neighbors.push_back({number[i], number[j], number[k]});
    out.normals.push_back(face.normal);
    for (std::uint32_t p = face.first; p != no_index; p = next_[p]) out.outside.push_back({p, number[f]});
  }
  return out;
}

}  // namespace

HullTriangles quickhull(std::span<const GridPoint> points, const Simplex& simplex, double tolerance,
                        std::size_t max_vertices) {
  SOUPLE_ASSERT(simplex.count == 4, "a hull starts from a tet");
  Hull hull(points, tolerance);
  hull.start(simplex);
  hull.grow(max_vertices);
  return hull.result();
}

}  // namespace souple
