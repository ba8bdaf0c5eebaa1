#include "souple/collision/nearest.h"
#include "souple/rigid/manifold_points.h"
#include "souple/rigid/mesh_shape.h"

#include <algorithm>
#include <limits>

namespace souple {
namespace {

using manifold::ContactPoint;
using manifold::ContactPoints;

/// Normals within 1 degree share a manifold: the product of the normals exceeds this.
constexpr double equal_normals = 0.99985;
constexpr std::size_t most_manifolds = 8;

/// Points of one normal, with those of a in its local frame.
struct Group {
  Vec3d normal{};
  NormalOwner owner{};
  double radius = 0;  // of a's surface [m]
  ContactPoints points;

  /// The point within `distance` [m] of another, or null.
  ContactPoint* near(const Vec3d& point, double distance) {
    for (int i = 0; i < points.size(); ++i) {
      if (length_squared(points[i].point - point) <= distance * distance) return &points[i];
    }
    return nullptr;
  }
};
using Groups = manifold::StackList<Group, static_cast<int>(most_manifolds)>;

bool is_vertex_of_a(std::uint32_t feature) {
  return feature >> 30 == static_cast<std::uint32_t>(manifold::FeatureKind::vertex_of_a);
}

/// A vertex of a is the same on all triangles; other features belong to the triangle.
std::uint32_t feature_on(std::uint32_t feature, std::uint32_t triangle) {
  if (is_vertex_of_a(feature)) return feature;
  const std::uint32_t mixed = (feature ^ triangle * 0x9e3779b1u) * 0x85ebca6bu;
  return (feature & 0xc0000000u) | (mixed >> 2);
}

Group* group_of(Groups& groups, const Manifold& found, std::size_t capacity) {
  for (int g = 0; g < groups.size(); ++g) {
    if (dot(groups[g].normal, found.normal) >= equal_normals) return &groups[g];
  }
  if (static_cast<std::size_t>(groups.size()) >= capacity) return nullptr;
  groups.push_back({.normal = found.normal, .owner = found.owner, .radius = found.radius_a, .points = {}});
  return &groups[groups.size() - 1];
}

/// Adds the points that the group does not have. A vertex of a replaces another point at its place, because its feature
/// persists.
void add(Group& group, const Manifold& found, std::uint32_t triangle, const Vec3d& local_normal,
         double slack) {
  for (int k = 0; k < found.count; ++k) {
    const ManifoldPoint& p = found.points[static_cast<std::size_t>(k)];
    const ContactPoint point{p.on_a, p.separation, feature_on(p.feature, triangle)};
    if (ContactPoint* const same = group.near(p.on_a, 2 * slack)) {
      if (is_vertex_of_a(point.feature) && !is_vertex_of_a(same->feature)) *same = point;
      continue;
    }
    if (group.points.full()) manifold::reduce_to_four(group.points, local_normal, 0.1 * slack);
    group.points.push_back(point);
  }
}

/// The side of a piece of the mesh on which the shape's center lies: that of the piece's nearest point. A triangle beyond
/// an edge may have its back to the center although the shape is in front of the piece.
class Sides {
 public:
  explicit Sides(const Vec3d& center) : center_(center) {}

  void consider(const MeshShape& mesh, std::uint32_t t) {
    const auto [a, b, c] = mesh.triangle(t, false).corners;
    const Vec3d n = normalized(cross(b - a, c - a));
    if (n == Vec3d{}) return;
    double weight[3];
    nearest_on_triangle(center_, a, b, c, weight);
    const Vec3d way = center_ - a * weight[0] - b * weight[1] - c * weight[2];
    const Side found{mesh.piece(t), length_squared(way), dot(way, n)};
    for (int k = 0; k < sides_.size(); ++k)
      if (sides_[k].piece == found.piece) return replace(sides_[k], found);
    sides_.push_back(found);
  }
  bool is_back(const MeshShape& mesh, std::uint32_t t) const {
    for (int k = 0; k < sides_.size(); ++k)
      if (sides_[k].piece == mesh.piece(t)) return sides_[k].height < 0;
    const auto [a, b, c] = mesh.triangle(t, false).corners;  // more pieces than the list holds
    return dot(cross(b - a, c - a), center_ - a) < 0;
  }

 private:
  struct Side {
    std::uint32_t piece;
    double squared;  // distance of the center [m^2]
    double height;   // of the center above the nearest triangle [m]
  };

  // If the nearest point is on an edge, the triangle that faces the center more tells the side.
  static void replace(Side& side, const Side& by) {
    constexpr double rounding = 1e-9;
    if (by.squared > side.squared * (1 + rounding)) return;
    const bool nearer = by.squared < side.squared * (1 - rounding);
    if (nearer || std::abs(by.height) > std::abs(side.height)) side.height = by.height;
    side.squared = std::min(side.squared, by.squared);
  }

  Vec3d center_;
  manifold::StackList<Side, 32> sides_;
};

/// The bounding box of a shape in another frame, grown by a margin.
Bounds box_in(const manifold::FrameChange& frame, const ShapeBounds& local, double margin) {
  const Vec3d middle = frame.point((local.lo + local.hi) * 0.5), half = (local.hi - local.lo) * 0.5;
  Vec3d extent{margin, margin, margin};
  for (int row = 0; row < 3; ++row)
    for (int k = 0; k < 3; ++k) extent[row] += std::abs(frame.rotation(row, k)) * half[k];
  return {Vec3f(middle - extent), Vec3f(middle + extent)};
}

}  // namespace

int find_manifolds(const ConvexShape& a, const BodyPose& pose_a, const MeshShape& b, const BodyPose& pose_b,
                   double margin, std::span<Manifold> out, const PairMotion& motion) {
  const double slack = 5e-4 * a.outer_radius;
  const manifold::FrameChange to_b = manifold::frame_change(pose_a, pose_b);
  const Bounds box = box_in(to_b, a.bounds, margin + a.side.sagitta);
  Sides sides(to_b.point(a.center));
  b.for_each_in(box, [&](std::uint32_t t) { sides.consider(b, t); });
  Groups groups;
  b.for_each_in(box, [&](std::uint32_t t) {
    AxisCache cache;
    const Manifold found =
        find_manifold(a, pose_a, b.triangle(t, sides.is_back(b, t)), pose_b, margin, cache, motion);
    if (found.count == 0) return;
    Group* group = group_of(groups, found, std::min(out.size(), most_manifolds));
    if (group == nullptr) return;
    add(*group, found, t, pose_a.local_direction(group->normal), slack);
  });
  for (int g = 0; g < groups.size(); ++g) {
    Group& group = groups[g];
    manifold::reduce_to_four(group.points, pose_a.local_direction(group.normal), 0.1 * slack);
    Manifold& m = out[static_cast<std::size_t>(g)];
    m = {.normal = group.normal, .owner = group.owner, .radius_a = group.radius, .points = {}};
    for (int i = 0; i < group.points.size(); ++i) {
      const Vec3d on_a = group.points[i].point;
      const Vec3d on_b = pose_a.point(on_a) - group.normal * group.points[i].height;
      m.points[static_cast<std::size_t>(m.count++)] = {on_a, pose_b.local_point(on_b), group.points[i].height,
                                                       group.points[i].feature};
    }
  }
  return groups.size();
}

}  // namespace souple
