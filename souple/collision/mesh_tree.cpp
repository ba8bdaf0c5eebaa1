#include "souple/collision/mesh_tree.h"

#include "souple/assert.h"
#include "souple/collision/nearest.h"
#include "souple/error.h"
#include "souple/math/elementary.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <tuple>
#include <utility>

namespace souple {
namespace {

constexpr std::uint32_t leaf_size = 4;
// A box counts as a dipole beyond this many radii: beta of Barill et al. 2018, who take 2 as well.
constexpr double far_radii = 2;

double squared_distance_to_box(const Vec3d& lo, const Vec3d& hi, const Vec3d& p) {
  double sum = 0;
  for (int k = 0; k < 3; ++k) {
    const double beyond = max(max(lo[k] - p[k], p[k] - hi[k]), 0.0);
    sum += beyond * beyond;
  }
  return sum;
}

// Two unit vectors perpendicular to the unit vector n, the first one as near to `along` as possible.
std::pair<Vec3d, Vec3d> perpendicular(const Vec3d& n, const Vec3d& along) {
  Vec3d u = along - n * dot(n, along);
  if (!(length_squared(u) > 1e-6 * length_squared(along))) {
    const Vec3d size{std::abs(n.x), std::abs(n.y), std::abs(n.z)};
    const Vec3d other = size.x <= size.y && size.x <= size.z ? Vec3d{1, 0, 0}
                        : size.y <= size.z                   ? Vec3d{0, 1, 0}
                                                             : Vec3d{0, 0, 1};
    u = other - n * dot(n, other);
  }
  u = u / length(u);
  return {u, cross(n, u)};
}

}  // namespace

MeshTree::MeshTree(std::span<const Vec3d> positions, std::span<const Triangle> triangles) {
  if (triangles.empty()) throw Error("MeshTree: no triangles; expected at least one");
  triangles_.reserve(triangles.size());
  for (const Triangle& t : triangles) {
    const Vec3d &a = positions[t[0]], &b = positions[t[1]], &c = positions[t[2]];
    const Vec3d middle = (a + b + c) / 3.0;
    triangles_.push_back(
        {a, b, c, middle, max(length(a - middle), max(length(b - middle), length(c - middle)))});
    for (const Vec3d& corner : {a, b, c}) rounding_ = max(rounding_, 1e-13 * length(corner));
  }
  nodes_.reserve(triangles.size());
  build(0, static_cast<std::uint32_t>(triangles_.size()));
}

MeshTree::Node MeshTree::node_of(std::uint32_t begin, std::uint32_t end) const {
  SOUPLE_ASSERT(begin < end && end <= triangles_.size(), "a node has triangles");
  Node node;
  node.begin = begin;
  node.end = end;
  node.lo = node.hi = triangles_[begin].a;
  double area = 0;
  for (std::uint32_t i = begin; i < end; ++i) {
    const Corners& t = triangles_[i];
    for (const Vec3d& corner : {t.a, t.b, t.c}) {
      for (int k = 0; k < 3; ++k) {
        node.lo[k] = min(node.lo[k], corner[k]);
        node.hi[k] = max(node.hi[k], corner[k]);
      }
    }
    const Vec3d area_normal = cross(t.b - t.a, t.c - t.a) * 0.5;
    node.area_normal += area_normal;
    node.center += (t.a + t.b + t.c) * (length(area_normal) / 3);
    area += length(area_normal);
  }
  node.center = area > 0 ? node.center / area : (node.lo + node.hi) * 0.5;
  Vec3d extent;
  for (int k = 0; k < 3; ++k) extent[k] = max(node.hi[k] - node.center[k], node.center[k] - node.lo[k]);
  node.radius = length(extent);
  node.slab = slab_of(node);
  return node;
}

bool MeshTree::Slab::is_beyond(const Vec3d& point, double distance) const {
  const Vec3d along{dot(axis[0], point), dot(axis[1], point), dot(axis[2], point)};
  return squared_distance_to_box(lo, hi, along) > distance * distance;
}

MeshTree::Slab MeshTree::slab_of(const Node& node) const {
  Slab slab;
  Vec3d longest{1, 0, 0};
  double squared = 0;
  for (std::uint32_t i = node.begin; i < min(node.end, node.begin + leaf_size); ++i) {
    const Corners& t = triangles_[i];
    for (const Vec3d& edge : {t.b - t.a, t.c - t.b, t.a - t.c})
      if (length_squared(edge) > squared) longest = edge, squared = length_squared(edge);
  }
  const double area = length(node.area_normal);
  slab.axis[2] = area > 0 ? node.area_normal / area : Vec3d{0, 0, 1};
  std::tie(slab.axis[0], slab.axis[1]) = perpendicular(slab.axis[2], longest);
  for (int k = 0; k < 3; ++k) {
    const auto along = [&](const Vec3d& corner) { return dot(slab.axis[k], corner); };
    slab.lo[k] = slab.hi[k] = along(triangles_[node.begin].a);
    for (std::uint32_t i = node.begin; i < node.end; ++i)
      for (const Vec3d& corner : {triangles_[i].a, triangles_[i].b, triangles_[i].c}) {
        slab.lo[k] = min(slab.lo[k], along(corner));
        slab.hi[k] = max(slab.hi[k], along(corner));
      }
  }
  return slab;
}

std::uint32_t MeshTree::build(std::uint32_t begin, std::uint32_t end) {
  const auto index = static_cast<std::uint32_t>(nodes_.size());
  nodes_.push_back(node_of(begin, end));
  if (end - begin <= leaf_size) return index;
  const Vec3d size = nodes_[index].hi - nodes_[index].lo;
  const int axis = size.x >= size.y && size.x >= size.z ? 0 : (size.y >= size.z ? 1 : 2);
  const std::uint32_t middle = begin + (end - begin) / 2;
  const auto at = [&](std::uint32_t i) { return triangles_.begin() + static_cast<std::ptrdiff_t>(i); };
  std::nth_element(at(begin), at(middle), at(end), [axis](const Corners& s, const Corners& t) {
    return s.a[axis] + s.b[axis] + s.c[axis] < t.a[axis] + t.b[axis] + t.c[axis];
  });
  build(begin, middle);
  const std::uint32_t right = build(middle, end);
  nodes_[index].right = right;
  return index;
}

double MeshTree::squared_distance(const Corners& t, const Vec3d& point) {
  double weight[3];
  nearest_on_triangle(point, t.a, t.b, t.c, weight);
  return length_squared((t.a - point) * weight[0] + (t.b - point) * weight[1] + (t.c - point) * weight[2]);
}

MeshTree::Nearest MeshTree::nearest(const Vec3d& point, std::uint32_t guess, double tolerance) const {
  const double enough = (1 + tolerance) * (1 + tolerance);
  std::uint32_t best = guess < triangles_.size() ? guess : 0;
  double least = squared_distance(triangles_[best], point), distance = sqrt(least);
  Stack stack{};
  std::size_t depth = 1;
  const auto far = [&](std::uint32_t n) {
    return squared_distance_to_box(nodes_[n].lo, nodes_[n].hi, point);
  };
  while (depth > 0) {
    const std::uint32_t n = stack[--depth];
    const Node& node = nodes_[n];
    if (far(n) * enough > least) continue;
    if (tolerance == 0 && node.slab.is_beyond(point, distance + rounding_)) continue;
    if (node.right == 0) {
      for (std::uint32_t i = node.begin; i < node.end; ++i) {
        const double max_distance = distance + triangles_[i].radius;
        if (length_squared(triangles_[i].middle - point) > max_distance * max_distance) continue;
        const double squared = squared_distance(triangles_[i], point);
        if (squared < least) least = squared, best = i, distance = sqrt(squared);
      }
      continue;
    }
    const bool left_first = far(n + 1) <= far(node.right);
    SOUPLE_ASSERT(depth + 2 <= stack.size(), "the tree is balanced");
    stack[depth++] = left_first ? node.right : n + 1;
    stack[depth++] = left_first ? n + 1 : node.right;
  }
  return {distance, best};
}

bool MeshTree::may_cross(const Vec3d& from, const Vec3d& to) const {
  const Vec3d middle = (from + to) * 0.5;
  const double reach = 0.5 * length(to - from) + rounding_;
  Stack stack{};
  std::size_t depth = 1;
  while (depth > 0) {
    const std::uint32_t n = stack[--depth];
    const Node& node = nodes_[n];
    if (squared_distance_to_box(node.lo, node.hi, middle) > reach * reach ||
        node.slab.is_beyond(middle, reach))
      continue;
    if (node.right == 0) {
      for (std::uint32_t i = node.begin; i < node.end; ++i) {
        const Corners& t = triangles_[i];
        const Vec3d normal = cross(t.b - t.a, t.c - t.a);
        const double a = dot(normal, from - t.a), b = dot(normal, to - t.a);
        const double near = length(normal) * (rounding_ + 1e-6 * reach);
        if (!(min(a, b) > near || max(a, b) < -near)) return true;
      }
      continue;
    }
    SOUPLE_ASSERT(depth + 2 <= stack.size(), "the tree is balanced");
    stack[depth++] = node.right;
    stack[depth++] = n + 1;
  }
  return false;
}

// tan(angle / 2) = a . (b x c) / (|a||b||c| + (a . b)|c| + (b . c)|a| + (c . a)|b|),
// a, b, c relative to the point (van Oosterom & Strackee 1983, eq. 8). Positive where the point is behind the
// triangle.
double MeshTree::solid_angle(const Corners& t, const Vec3d& point) {
  const Vec3d a = t.a - point, b = t.b - point, c = t.c - point;
  const double la = length(a), lb = length(b), lc = length(c);
  const double sine = dot(a, cross(b, c));
  const double cosine = la * lb * lc + dot(a, b) * lc + dot(b, c) * la + dot(c, a) * lb;
  return 2 * elementary::atan2(sine, cosine);
}

double MeshTree::winding_number(const Vec3d& point) const {
  double angle = 0;
  Stack stack{};
  std::size_t depth = 1;
  while (depth > 0) {
    const std::uint32_t n = stack[--depth];
    const Node& node = nodes_[n];
    const Vec3d to = node.center - point;
    const double squared = length_squared(to), near = far_radii * node.radius;
    if (squared > near * near) {
      angle += dot(to, node.area_normal) / (squared * sqrt(squared));
    } else if (node.right == 0) {
      for (std::uint32_t i = node.begin; i < node.end; ++i) angle += solid_angle(triangles_[i], point);
    } else {
      SOUPLE_ASSERT(depth + 2 <= stack.size(), "the tree is balanced");
      stack[depth++] = node.right;
      stack[depth++] = n + 1;
    }
  }
  return angle / (4 * std::numbers::pi);
}

}  // namespace souple
