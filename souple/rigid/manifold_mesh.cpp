#include "souple/rigid/manifold.h"
#include "souple/rigid/manifold_points.h"

#include <algorithm>

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

}  // namespace

int find_manifolds(const ConvexShape& a, const BodyPose& pose_a, std::span<const ContactTriangle> triangles,
                   std::span<const std::uint32_t> names, const BodyPose& pose_b, double margin,
                   std::span<Manifold> out) {
  const double slack = 5e-4 * a.outer_radius;
  Groups groups;
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    AxisCache cache;
    const Manifold found = find_manifold(a, pose_a, triangles[t], pose_b, margin, cache);
    if (found.count == 0) continue;
    Group* group = group_of(groups, found, std::min(out.size(), most_manifolds));
    if (group == nullptr) continue;
    add(*group, found, names[t], pose_a.local_direction(group->normal), slack);
  }
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
