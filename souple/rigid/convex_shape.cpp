#include "souple/rigid/convex_shape.h"

#include "souple/error.h"
#include "souple/geometry/circle.h"
#include "souple/geometry/convex_hull.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <type_traits>
#include <utility>

#include <fmt/core.h>

namespace souple {
namespace {

void expect_positive(double size, const char* shape, const char* what) {
  if (!(size > 0) || !std::isfinite(size)) {
    throw Error(fmt::format("{} of a {}: {:g}, expected a positive number of meters", what, shape, size));
  }
}

/// Twice the area of a face as a vector along its normal (Newell). Relative to its first corner, to lose no digits.
Vec3d area_vector(std::span<const Vec3d> vertices, const FaceLoop& loop) {
  Vec3d sum{};
  for (std::size_t k = 1; k + 1 < loop.size(); ++k) {
    sum += cross(vertices[loop[k]] - vertices[loop[0]], vertices[loop[k + 1]] - vertices[loop[0]]);
  }
  return sum;
}

void check_loop(std::span<const Vec3d> vertices, const FaceLoop& loop, std::size_t face) {
  if (loop.size() < 3) {
    throw Error(
        fmt::format("face {} of a convex polyhedron has {} corners, expected at least 3", face, loop.size()));
  }
  for (const std::uint32_t v : loop) {
    if (v >= vertices.size()) {
      throw Error(fmt::format("face {} of a convex polyhedron has the vertex {}, expected indices below {}",
                              face, v, vertices.size()));
    }
  }
  if (!(length_squared(area_vector(vertices, loop)) > 0)) {
    throw Error(fmt::format("face {} of a convex polyhedron has no area: remove it", face));
  }
}

ConvexFace plane_of(std::span<const Vec3d> vertices, const FaceLoop& loop) {
  ConvexFace face{.normal = normalized(area_vector(vertices, loop)),
                  .offset = -std::numeric_limits<double>::infinity()};
  for (const std::uint32_t v : loop) face.offset = std::max(face.offset, dot(face.normal, vertices[v]));
  return face;
}

/// The directed sides of all faces, sorted such that the two sides of an edge are neighbors.
struct Side {
  std::uint32_t low, high, face, corner;
  bool forward;  // from low to high
};

std::vector<Side> sorted_sides(std::span<const FaceLoop> faces) {
  std::vector<Side> sides;
  for (std::uint32_t f = 0; f < faces.size(); ++f) {
    const auto count = static_cast<std::uint32_t>(faces[f].size());
    for (std::uint32_t k = 0; k < count; ++k) {
      const std::uint32_t a = faces[f][k], b = faces[f][(k + 1) % count];
      sides.push_back({std::min(a, b), std::max(a, b), f, k, a < b});
    }
  }
  std::sort(sides.begin(), sides.end(), [](const Side& s, const Side& t) {
    return std::pair(std::pair(s.low, s.high), !s.forward) < std::pair(std::pair(t.low, t.high), !t.forward);
  });
  return sides;
}

/// Fills in the edges. Returns the edge of each side of each face.
std::vector<FaceLoop> connect(ConvexShape& shape, std::span<const FaceLoop> faces) {
  std::vector<FaceLoop> edge_of(faces.size());
  for (std::size_t f = 0; f < faces.size(); ++f) edge_of[f].resize(faces[f].size());
  const std::vector<Side> sides = sorted_sides(faces);
  for (std::size_t i = 0; i < sides.size(); i += 2) {
    const auto same = [&](std::size_t j) {
      return j < sides.size() && sides[j].low == sides[i].low && sides[j].high == sides[i].high;
    };
    if (!same(i + 1) || same(i + 2) || !sides[i].forward || sides[i + 1].forward) {
      throw Error(fmt::format(
          "the faces of a convex polyhedron are not closed: expected one face on each side of the edge "
          "{}-{}, with opposite directions",
          sides[i].low, sides[i].high));
    }
    const Vec3d left = shape.faces[sides[i].face].normal, right = shape.faces[sides[i + 1].face].normal;
    edge_of[sides[i].face][sides[i].corner] = static_cast<std::uint32_t>(shape.edges.size());
    edge_of[sides[i + 1].face][sides[i + 1].corner] = static_cast<std::uint32_t>(shape.edges.size());
    shape.edges.push_back({sides[i].low, sides[i].high, sides[i].face, sides[i + 1].face, dot(left, right),
                           normalized(left + right)});
  }
  return edge_of;
}

/// Appends the corners of a face, at most max_face_corners.
void add_corners(ConvexShape& shape, ConvexFace& face, const FaceLoop& loop, const FaceLoop& edge_of) {
  const std::size_t count = std::min<std::size_t>(loop.size(), max_face_corners);
  face.begin = static_cast<std::uint32_t>(shape.corners.size());
  for (std::size_t k = 0; k < count; ++k) {
    const std::size_t here = k * loop.size() / count, next = (k + 1) * loop.size() / count % loop.size();
    const Vec3d a = shape.vertices[loop[here]], b = shape.vertices[loop[next]];
    const Vec3d side = normalized(cross(b - a, face.normal));
    shape.corners.push_back({loop[here], edge_of[here], side, dot(side, a)});
  }
  face.end = static_cast<std::uint32_t>(shape.corners.size());
}

double distance_to_faces(const ConvexShape& shape, const Vec3d& point) {
  double least = std::numeric_limits<double>::infinity();
  for (const ConvexFace& face : shape.faces) least = std::min(least, face.offset - dot(face.normal, point));
  return least;
}

/// Bounds, and a ball inside the polyhedron: about the better one of two centers.
void measure(ConvexShape& shape) {
  Vec3d lo = shape.vertices[0], hi = lo, mean{};
  double farthest = 0;
  for (const Vec3d& v : shape.vertices) {
    lo = {std::min(lo.x, v.x), std::min(lo.y, v.y), std::min(lo.z, v.z)};
    hi = {std::max(hi.x, v.x), std::max(hi.y, v.y), std::max(hi.z, v.z)};
    mean += v / static_cast<double>(shape.vertices.size());
    farthest = std::max(farthest, length(v));
  }
  const Vec3d rounding{shape.radius, shape.radius, shape.radius};
  shape.bounds = {lo - rounding, hi + rounding};
  shape.bounding_radius = farthest + shape.radius;
  shape.center = (lo + hi) / 2.0;
  if (!shape.faces.empty()) {
    if (distance_to_faces(shape, mean) > distance_to_faces(shape, shape.center)) shape.center = mean;
    shape.inner_radius = std::max(0.0, distance_to_faces(shape, shape.center));
  }
  shape.outer_radius = 0;
  for (const Vec3d& v : shape.vertices)
    shape.outer_radius = std::max(shape.outer_radius, length(v - shape.center));
  shape.outer_radius += shape.radius;
}

void expect_convex(const ConvexShape& shape, std::span<const FaceLoop> faces) {
  const double allowed = 1e-4 * length(shape.bounds.hi - shape.bounds.lo);
  for (std::size_t f = 0; f < shape.faces.size(); ++f) {
    for (const std::uint32_t v : faces[f]) {
      if (shape.faces[f].offset - dot(shape.faces[f].normal, shape.vertices[v]) > allowed) {
        throw Error(
            fmt::format("face {} of a convex polyhedron is not flat at its vertex {}: split it", f, v));
      }
    }
    for (const Vec3d& v : shape.vertices) {
      if (dot(shape.faces[f].normal, v) - shape.faces[f].offset > allowed) {
        throw Error(fmt::format(
            "a polyhedron of {} vertices is not convex: a vertex lies outside face {}; expected faces "
            "that are counterclockwise from outside; use the convex hull",
            shape.vertices.size(), f));
      }
    }
  }
}

}  // namespace

ConvexShape convex_sphere(double radius) {
  expect_positive(radius, "sphere", "radius");
  ConvexShape shape;
  shape.vertices = {{}};
  shape.radius = radius;
  measure(shape);
  return shape;
}

ConvexShape convex_capsule(double radius, double half_height) {
  expect_positive(radius, "capsule", "radius");
  if (half_height == 0) return convex_sphere(radius);
  expect_positive(half_height, "capsule", "half height");
  ConvexShape shape;
  shape.vertices = {{0, -half_height, 0}, {0, half_height, 0}};
  shape.edges = {{.from = 0, .to = 1}};
  shape.radius = radius;
  measure(shape);
  return shape;
}

ConvexShape convex_box(const Vec3d& half_extents) {
  std::vector<Vec3d> vertices;
  for (int i = 0; i < 8; ++i) {
    if (i < 3) expect_positive(half_extents[i], "box", "half extent");
    vertices.push_back({(i & 1) != 0 ? half_extents.x : -half_extents.x,
                        (i & 2) != 0 ? half_extents.y : -half_extents.y,
                        (i & 4) != 0 ? half_extents.z : -half_extents.z});
  }
  const std::vector<FaceLoop> faces{{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4},
                                    {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}};
  return convex_polyhedron(vertices, faces);
}

ConvexShape convex_cylinder(double radius, double half_height, int sides) {
  expect_positive(radius, "cylinder", "radius");
  expect_positive(half_height, "cylinder", "half height");
  if (sides < 3) throw Error(fmt::format("a cylinder has {} sides, expected at least 3", sides));
  const auto count = static_cast<std::uint32_t>(sides);
  std::vector<Vec3d> vertices;
  std::vector<FaceLoop> faces(2);
  for (std::uint32_t i = 0; i < count; ++i) {
    const CirclePoint on_circle = circle_point(i, count);
    for (const double y : {-half_height, half_height}) {
      vertices.push_back({radius * on_circle.cosine, y, -radius * on_circle.sine});
    }
    const std::uint32_t next = (i + 1) % count;
    faces.push_back({2 * i, 2 * next, 2 * next + 1, 2 * i + 1});
    faces[0].push_back(2 * (count - 1 - i));
    faces[1].push_back(2 * i + 1);
  }
  ConvexShape shape = convex_polyhedron(vertices, faces);
  shape.side = {{0, -half_height, 0}, {0, half_height, 0}, radius, radius - shape.faces[2].offset};
  return shape;
}

ConvexShape convex_polyhedron(std::span<const Vec3d> vertices, std::span<const FaceLoop> faces,
                              double radius) {
  if (!(radius >= 0) || !std::isfinite(radius)) {
    throw Error(fmt::format("rounding radius of a convex polyhedron: {:g}, expected a number of meters >= 0",
                            radius));
  }
  if (vertices.size() < 4 || faces.size() < 4 ||
      !std::all_of(vertices.begin(), vertices.end(), [](const Vec3d& v) { return is_finite(v); })) {
    throw Error(fmt::format(
        "a convex polyhedron has {} vertices and {} faces, expected at least 4 of each, and finite "
        "positions",
        vertices.size(), faces.size()));
  }
  ConvexShape shape;
  shape.radius = radius;
  shape.vertices.assign(vertices.begin(), vertices.end());
  for (std::size_t f = 0; f < faces.size(); ++f) {
    check_loop(vertices, faces[f], f);
    shape.faces.push_back(plane_of(vertices, faces[f]));
  }
  const std::vector<FaceLoop> edge_of = connect(shape, faces);
  for (std::size_t f = 0; f < faces.size(); ++f) add_corners(shape, shape.faces[f], faces[f], edge_of[f]);
  measure(shape);
  expect_convex(shape, faces);
  return shape;
}

ConvexShape convex_polyhedron(const ConvexHull& hull, double radius) {
  std::vector<FaceLoop> faces;
  for (const HullFace& face : hull.faces) {
    const std::span<const std::uint32_t> loop = hull.loop(face);
    faces.emplace_back(loop.begin(), loop.end());
  }
  return convex_polyhedron(hull.positions, faces, radius);
}

std::optional<ConvexShape> convex_shape_of(const Shape& shape) {
  return std::visit(
      [](const auto& s) -> std::optional<ConvexShape> {
        using S = std::decay_t<decltype(s)>;
        if constexpr (std::is_same_v<S, Plane> || std::is_same_v<S, SignedDistanceField>) {
          return std::nullopt;
        } else {
          const BodyPose at{Vec3d(s.center), {}};
          if constexpr (std::is_same_v<S, Sphere>) return moved(convex_sphere(s.radius), at);
          if constexpr (std::is_same_v<S, Box>) return moved(convex_box(Vec3d(s.half_extents)), at);
          if constexpr (std::is_same_v<S, Capsule>) return moved(convex_capsule(s.radius, s.half_height), at);
          if constexpr (std::is_same_v<S, Cylinder>)
            return moved(convex_cylinder(s.radius, s.half_height), at);
        }
      },
      shape);
}

ConvexShape moved(const ConvexShape& shape, const BodyPose& pose) {
  ConvexShape out = shape;
  for (Vec3d& v : out.vertices) v = pose.point(v);
  out.side.from = pose.point(out.side.from), out.side.to = pose.point(out.side.to);
  for (ConvexFace& face : out.faces) {
    face.normal = pose.direction(face.normal);
    face.offset += dot(face.normal, pose.position);
  }
  for (ConvexCorner& corner : out.corners) {
    corner.side_normal = pose.direction(corner.side_normal);
    corner.side_offset += dot(corner.side_normal, pose.position);
  }
  for (ConvexEdge& edge : out.edges) edge.outward = pose.direction(edge.outward);
  measure(out);
  return out;
}

}  // namespace souple
