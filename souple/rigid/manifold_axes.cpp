#include "souple/rigid/manifold_axes.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace souple::manifold {
namespace {

constexpr double unbounded = std::numeric_limits<double>::infinity();

/// The largest product of d with a unit vector between the normals of an edge's two faces. `left` and `right`: products
/// of d with these normals. If the projection of d onto their plane lies between them, its length is the maximum.
double largest_between(double left, double right, double cosine) {
  const double sine_squared = 1 - cosine * cosine;
  if (sine_squared > 1e-9 && left >= cosine * right && right >= cosine * left) {
    return std::sqrt(std::max(0.0, (left * left + right * right - 2 * cosine * left * right) / sine_squared));
  }
  return std::max(left, right);
}

/// The largest product of a unit axis through an edge, outward, with the vector from the edge to a point.
double largest_reach(const ConvexView& shape, const ConvexEdge& edge, const Vec3d& point) {
  const ConvexFace &left = shape.edge_faces[edge.left], &right = shape.edge_faces[edge.right];
  return largest_between(dot(left.normal, point) - left.offset, dot(right.normal, point) - right.offset,
                         edge.cosine);
}

/// Points of one shape in the frame of the other: a ball inside it, and a point of it.
struct InnerPoints {
  Vec3d center;
  double radius;
  Vec3d point;
  bool has_point;
};

/// Whether some axis through an edge may separate its shape from the other by more than `floor`. An axis n through the
/// edge's point p separates by at most n . (x - p) for any point x of the other shape.
bool may_exceed(const ConvexView& shape, const ConvexEdge& edge, const InnerPoints& other, double floor) {
  if (edge.left == no_face) return true;
  if (largest_reach(shape, edge, other.center) - other.radius <= floor) return false;
  return !other.has_point || largest_reach(shape, edge, other.point) > floor;
}

/// An edge of b in a's frame, with its directions negated: those of b's Gauss map that face a's.
struct OpposedEdge {
  Vec3d point, direction, left, right, outward;
  std::uint32_t index;
  bool has_faces;
};

OpposedEdge opposed(const ConvexView& b, std::uint32_t index, const FrameChange& b_to_a) {
  const ConvexEdge& edge = b.edges[index];
  OpposedEdge out{.point = b_to_a.point(b.vertices[edge.from]),
                  .direction = b_to_a.direction(b.vertices[edge.to] - b.vertices[edge.from]),
                  .left = {},
                  .right = {},
                  .outward = {},
                  .index = index,
                  .has_faces = edge.left != no_face};
  if (out.has_faces) {
    out.left = -b_to_a.direction(b.edge_faces[edge.left].normal);
    out.right = -b_to_a.direction(b.edge_faces[edge.right].normal);
    out.outward = -b_to_a.direction(edge.outward);
  }
  return out;
}

/// An edge of a, in a's frame.
struct OwnEdge {
  Vec3d point, direction, left, right, outward;
  bool has_faces;
};

OwnEdge own(const ConvexView& a, const ConvexEdge& edge) {
  OwnEdge out{a.vertices[edge.from], a.vertices[edge.to] - a.vertices[edge.from], {}, {}, edge.outward,
              edge.left != no_face};
  if (out.has_faces) out.left = a.edge_faces[edge.left].normal, out.right = a.edge_faces[edge.right].normal;
  return out;
}

/// The axis of a pair of edges, not normalized. It is zero if the arcs of the two edges on the Gauss map do not cross.
/// Then the Minkowski difference has no face of these edges.
Vec3d axis_of(const OwnEdge& a, const OpposedEdge& b) {
  if (b.has_faces && dot(b.left, a.direction) * dot(b.right, a.direction) >= 0) return {};
  if (a.has_faces && dot(a.left, b.direction) * dot(a.right, b.direction) >= 0) return {};
  Vec3d axis = cross(a.direction, b.direction);
  constexpr double least_sine = 1e-5;  // nearly parallel edges: face normals and closest points cover them
  if (length_squared(axis) <=
      least_sine * least_sine * length_squared(a.direction) * length_squared(b.direction)) {
    return {};
  }
  const Vec3d& outward = a.has_faces ? a.outward : b.outward;
  if (dot(axis, outward) < 0) axis = -axis;
  if (a.has_faces && b.has_faces && !(dot(axis, b.outward) > 0)) return {};
  return axis;
}

constexpr int chunk = 32;
using OpposedEdges = StackList<OpposedEdge, chunk>;

void compare(EdgeAxis& best, const OwnEdge& own_edge, std::uint32_t index, const OpposedEdges& opposed_edges,
             const NormalRegion* region) {
  for (int j = 0; j < opposed_edges.size(); ++j) {
    const OpposedEdge& other = opposed_edges[j];
    const Vec3d axis = axis_of(own_edge, other);
    const double squared = length_squared(axis);
    if (!(squared > 0)) continue;
    const double along = dot(axis, other.point - own_edge.point);
    // Compared before the square root is taken: most pairs end here.
    if (along < 0 && best.separation >= 0) continue;
    const double inverse = 1 / std::sqrt(squared), separation = along * inverse;
    if (separation <= best.separation) continue;
    const Vec3d unit = axis * inverse;
    if (region != nullptr && !region->admits(-unit)) continue;
    best = {index, other.index, separation, unit};
  }
}

}  // namespace

FaceAxis face_axis(const ConvexView& reference, const ConvexView& other,
                   const FrameChange& other_to_reference, std::uint32_t face) {
  const ConvexFace& f = reference.faces[face];
  const double origin = dot(f.normal, other_to_reference.translation) - f.offset;
  return {face, origin + lowest_vertex(other.vertices, other_to_reference.back(f.normal)).height};
}

FaceAxis best_face_axis(const ConvexView& reference, const ConvexView& other,
                        const FrameChange& other_to_reference, double floor, const NormalRegion* region,
                        bool pushes_other) {
  FaceAxis best{no_face, floor};
  const Vec3d center = other_to_reference.point(other.center);
  for (std::uint32_t f = 0; f < reference.faces.size(); ++f) {
    const ConvexFace& face = reference.faces[f];
    // The ball inside the other shape is nearer than its lowest vertex.
    if (dot(face.normal, center) - face.offset - other.inner_radius <= best.separation) continue;
    if (region != nullptr && !region->admits(pushes_other ? face.normal : -face.normal)) continue;
    const FaceAxis axis = face_axis(reference, other, other_to_reference, f);
    if (axis.separation > best.separation) best = axis;
  }
  if (best.face == no_face) best.separation = -unbounded;
  return best;
}

EdgeAxis best_edge_axis(const ConvexView& a, const ConvexView& b, const FrameChange& b_to_a, double floor,
                        const DeepPoints& deep, const NormalRegion* region) {
  EdgeAxis best{.separation = floor};
  const InnerPoints of_b{b_to_a.point(b.center), b.inner_radius, deep.of_b, deep.has_b};
  const InnerPoints of_a{b_to_a.back(a.center - b_to_a.translation), a.inner_radius,
                         b_to_a.back(deep.of_a - b_to_a.translation), deep.has_a};
  OpposedEdges opposed_edges;
  for (std::uint32_t j = 0; j < b.edges.size(); ++j) {
    if (may_exceed(b, b.edges[j], of_a, best.separation)) {
      opposed_edges.push_back(opposed(b, j, b_to_a));
    }
    if (!opposed_edges.full() && j + 1 < b.edges.size()) continue;
    if (opposed_edges.size() == 0) continue;
    for (std::uint32_t i = 0; i < a.edges.size(); ++i) {
      if (!may_exceed(a, a.edges[i], of_b, best.separation)) continue;
      compare(best, own(a, a.edges[i]), i, opposed_edges, region);
    }
    opposed_edges.clear();
  }
  if (best.a == no_face) best.separation = -unbounded;
  return best;
}

double separation_along(const ConvexView& a, const ConvexView& b, const FrameChange& b_to_a,
                        const Vec3d& axis) {
  const double lowest_b = lowest_vertex(b.vertices, b_to_a.back(axis)).height + dot(axis, b_to_a.translation);
  return lowest_b + lowest_vertex(a.vertices, -axis).height;
}

}  // namespace souple::manifold
