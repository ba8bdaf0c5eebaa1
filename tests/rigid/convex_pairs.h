#pragma once

#include "souple/geometry/convex_hull.h"
#include "souple/rigid/manifold.h"
#include "tests/collision/random.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>
#include <vector>

namespace souple::test {

inline Vec3d random_unit(Random& random) {
  Vec3d v;
  do v = random.point(-1, 1);
  while (length(v) > 1 || length(v) < 0.1);
  return normalized(v);
}

inline BodyPose random_pose(Random& random, double distance) {
  const Vec3d position = random_unit(random) * random.uniform(0, distance);
  const Vec3d axis = random_unit(random);
  return {position, Quatd::from_axis_angle(axis, random.uniform(0, 2 * std::numbers::pi))};
}

/// A tetrahedron that is no sliver.
inline ConvexShape random_tetrahedron(Random& random, double size, double radius) {
  while (true) {
    std::vector<Vec3d> x(4);
    for (Vec3d& v : x) v = random.point(-size, size);
    const double volume = dot(x[1] - x[0], cross(x[2] - x[0], x[3] - x[0]));
    if (std::abs(volume) < 0.5 * size * size * size) continue;
    if (volume < 0) std::swap(x[0], x[1]);
    const std::vector<FaceLoop> faces{{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {0, 3, 2}};
    return convex_polyhedron(x, faces, radius);
  }
}

/// A box with its edges along three random directions.
inline ConvexShape random_parallelepiped(Random& random, double size) {
  while (true) {
    const Vec3d a = random.point(-size, size), b = random.point(-size, size);
    Vec3d c = random.point(-size, size);
    const double volume = dot(a, cross(b, c));
    if (std::abs(volume) < 0.3 * size * size * size) continue;
    if (volume < 0) c = -c;
    std::vector<Vec3d> x;
    for (int i = 0; i < 8; ++i) {
      x.push_back(a * ((i & 1) != 0 ? 0.5 : -0.5) + b * ((i & 2) != 0 ? 0.5 : -0.5) +
                  c * ((i & 4) != 0 ? 0.5 : -0.5));
    }
    const std::vector<FaceLoop> faces{{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4},
                                      {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}};
    return convex_polyhedron(x, faces);
  }
}

/// A prism with flat sides.
inline ConvexShape prism(double radius, double half_height, int sides) {
  ConvexShape shape = convex_cylinder(radius, half_height, sides);
  shape.side = {};
  return shape;
}

/// The hull of some points in a ball.
inline ConvexShape random_hull(Random& random, double size, double radius) {
  std::vector<Vec3d> points(static_cast<std::size_t>(random.uniform(6, 20)));
  for (Vec3d& p : points) p = random_unit(random) * (size * random.uniform(0.5, 1));
  return convex_polyhedron(convex_hull(points), radius);
}

/// Spheres, capsules, boxes, prisms and other polyhedra, some of them rounded, of about the given size [m].
inline ConvexShape random_shape(Random& random, double size) {
  const double x = random.uniform(0.2, 1) * size, y = random.uniform(0.2, 1) * size,
               z = random.uniform(0.2, 1) * size;
  switch (static_cast<int>(random.uniform(0, 10))) {
    case 0:
      return convex_sphere(x);
    case 1:
      return convex_capsule(x / 2, y);
    case 2:
      return random_tetrahedron(random, size, 0);
    case 3:
      return random_tetrahedron(random, size / 2, x / 3);
    case 4:
      return prism(x, y, static_cast<int>(random.uniform(3, 16)));
    case 5:
      return random_parallelepiped(random, size);
    case 6:
      return random_hull(random, size, 0);
    case 7:
      return random_hull(random, size / 2, x / 4);
    default:
      return convex_box({x, y, z});
  }
}

/// Largest product of the shape's points with a unit direction, in the world: vertex by vertex.
inline double reach(const ConvexShape& shape, const BodyPose& pose, const Vec3d& direction) {
  double farthest = -std::numeric_limits<double>::infinity();
  for (const Vec3d& v : shape.vertices) farthest = std::max(farthest, dot(direction, pose.point(v)));
  return farthest + shape.radius;
}

/// Separation of two shapes along a unit axis from b to a, by projection.
inline double separation_along(const ConvexShape& a, const BodyPose& pose_a, const ConvexShape& b,
                               const BodyPose& pose_b, const Vec3d& axis) {
  return -reach(a, pose_a, -axis) - reach(b, pose_b, axis);
}

inline std::vector<Vec3d> edge_directions(const ConvexShape& shape, const BodyPose& pose) {
  std::vector<Vec3d> out;
  for (const ConvexEdge& e : shape.edges) {
    out.push_back(normalized(pose.direction(shape.vertices[e.to] - shape.vertices[e.from])));
  }
  return out;
}

/// The vertices of a shape in the world.
inline std::vector<Vec3d> world_vertices(const ConvexShape& shape, const BodyPose& pose) {
  std::vector<Vec3d> out;
  for (const Vec3d& v : shape.vertices) out.push_back(pose.point(v));
  return out;
}

/// The largest separation along all normals of faces, products of edges, and a number of random axes.
inline double largest_separation(const ConvexShape& a, const BodyPose& pose_a, const ConvexShape& b,
                                 const BodyPose& pose_b, Random& random, int random_axes) {
  const std::vector<Vec3d> on_a = world_vertices(a, pose_a), on_b = world_vertices(b, pose_b);
  double largest = -std::numeric_limits<double>::infinity();
  const auto interval = [](const std::vector<Vec3d>& x, const Vec3d& n) {
    double lo = dot(n, x[0]), hi = lo;
    for (const Vec3d& v : x) lo = std::min(lo, dot(n, v)), hi = std::max(hi, dot(n, v));
    return std::pair(lo, hi);
  };
  const auto consider = [&](const Vec3d& axis) {
    if (length_squared(axis) < 1e-8) return;
    const Vec3d n = normalized(axis);
    const auto [a_lo, a_hi] = interval(on_a, n);
    const auto [b_lo, b_hi] = interval(on_b, n);
    largest = std::max({largest, a_lo - b_hi - a.radius - b.radius, b_lo - a_hi - a.radius - b.radius});
  };
  for (const ConvexFace& f : a.faces) consider(pose_a.direction(f.normal));
  for (const ConvexFace& f : b.faces) consider(pose_b.direction(f.normal));
  const std::vector<Vec3d> edges_b = edge_directions(b, pose_b);
  for (const Vec3d& d : edge_directions(a, pose_a)) {
    for (const Vec3d& e : edges_b) consider(cross(d, e));
  }
  for (int i = 0; i < random_axes; ++i) consider(random_unit(random));
  return largest;
}

inline double least_separation(const Manifold& m) {
  double least = std::numeric_limits<double>::infinity();
  for (int i = 0; i < m.count; ++i) least = std::min(least, m.points[static_cast<std::size_t>(i)].separation);
  return least;
}

/// By find_manifold, with an empty cache.
inline Manifold find_fresh(const ConvexShape& a, const BodyPose& pose_a, const ConvexShape& b,
                           const BodyPose& pose_b, double margin) {
  AxisCache cache;
  return find_manifold(a, pose_a, b, pose_b, margin, cache);
}

}  // namespace souple::test
