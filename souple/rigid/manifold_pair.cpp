#include "souple/rigid/manifold_pair.h"

#include "souple/collision/nearest.h"
#include "souple/rigid/manifold_clip.h"
#include "souple/rigid/manifold_closest.h"

#include <algorithm>
#include <limits>

namespace souple::manifold {
namespace {

using Kind = AxisCache::Kind;

/// The axis by which a pair is pushed apart.
struct Axis {
  Kind kind = Kind::none;
  std::uint32_t a = 0, b = 0;  // faces or edges
  double separation = -std::numeric_limits<double>::infinity();
  Vec3d direction{};  // of edges: unit, from a to b, in a's frame
};

Axis of_face(const FaceAxis& face, Kind kind) {
  if (face.face == no_face) return {};
  return {kind,
          kind == Kind::face_of_a ? face.face : 0,
          kind == Kind::face_of_b ? face.face : 0,
          face.separation,
          {}};
}

Axis cached_face(const ShapePair& pair, const AxisCache& cache) {
  if (cache.kind == Kind::face_of_a && cache.a < pair.a.faces.size()) {
    return of_face(face_axis(pair.a, pair.b, pair.b_to_a, cache.a), Kind::face_of_a);
  }
  if (cache.kind == Kind::face_of_b && cache.b < pair.b.faces.size()) {
    return of_face(face_axis(pair.b, pair.a, pair.a_to_b, cache.b), Kind::face_of_b);
  }
  return {};
}

bool admits(const ShapePair& pair, const Axis& face) {
  if (pair.region == nullptr || face.kind == Kind::none) return true;
  return pair.region->admits(face.kind == Kind::face_of_a ? -pair.a.faces[face.a].normal
                                                          : pair.b.faces[face.b].normal);
}

/// The face of largest separation. `known`: a face whose separation is known already.
Axis best_face(const ShapePair& pair, const Axis& known) {
  Axis best = known;
  const FaceAxis of_a = best_face_axis(pair.a, pair.b, pair.b_to_a, best.separation, pair.region, false);
  if (of_a.face != no_face) best = of_face(of_a, Kind::face_of_a);
  const FaceAxis of_b = best_face_axis(pair.b, pair.a, pair.a_to_b, best.separation, pair.region, true);
  if (of_b.face != no_face) best = of_face(of_b, Kind::face_of_b);
  return best;
}

/// The lowest vertex of one shape along the normal of a face of the other. Also the point of the face below it, if that
/// lies within the face's sides.
DeepPoints deep_points(const ShapePair& pair, const Axis& axis) {
  if (axis.kind == Kind::none) return {};
  const bool of_a = axis.kind == Kind::face_of_a;
  const ConvexView &reference = of_a ? pair.a : pair.b, &incident = of_a ? pair.b : pair.a;
  const FrameChange& change = of_a ? pair.b_to_a : pair.a_to_b;
  const ConvexFace& face = reference.faces[of_a ? axis.a : axis.b];
  const Vec3d low =
      change.point(incident.vertices[lowest_vertex(incident.vertices, change.back(face.normal)).vertex]);
  const Vec3d on_face = low - face.normal * axis.separation;
  bool within = true;
  for (const ConvexCorner& corner : reference.corners_of(face)) {
    within = within && dot(corner.side_normal, on_face) <= corner.side_offset;
  }
  if (of_a) return {.of_a = on_face, .of_b = low, .has_a = within, .has_b = true};
  return {.of_a = pair.b_to_a.point(low), .of_b = pair.b_to_a.point(on_face), .has_a = true, .has_b = within};
}

Axis best_edges(const ShapePair& pair, const Axis& face, double floor) {
  if (pair.a.edges.empty() || pair.b.edges.empty()) return {};
  const DeepPoints deep = deep_points(pair, face);
  const EdgeAxis edges = best_edge_axis(pair.a, pair.b, pair.b_to_a, floor, deep, pair.region);
  if (edges.a == no_face) return {};
  return {Kind::edges, edges.a, edges.b, edges.separation, edges.axis};
}

/// Whether the last axis still separates the shapes by more than the margin.
bool separates(const ShapePair& pair, const AxisCache& cache, const Axis& cached) {
  if (cached.kind != Kind::none) return cached.separation >= pair.limit();
  if (cache.kind != Kind::edges && cache.kind != Kind::closest_points) return false;
  return separation_along(pair.a, pair.b, pair.b_to_a, cache.axis) >= pair.limit();
}

/// The axis of least penetration, or of largest separation. Faces before edges, the last axis before others.
Axis choose_axis(const ShapePair& pair, const Axis& cached) {
  const Axis face = best_face(pair, cached);
  if (face.separation >= pair.limit()) return face;
  const Axis edges = best_edges(pair, face, face.separation + pair.axis_tolerance);
  if (edges.kind != Kind::none) return edges;
  const bool keep = cached.kind != Kind::none && cached.separation >= face.separation - pair.axis_tolerance;
  return keep ? cached : face;
}

void remember(AxisCache& cache, const Axis& axis) {
  cache.kind = axis.kind, cache.a = axis.a, cache.b = axis.b, cache.axis = axis.direction;
}

void add_face_points(const ShapePair& pair, const Axis& axis, const ContactPoints& points,
                     Manifold& manifold) {
  const bool of_a = axis.kind == Kind::face_of_a;
  const Vec3d n = of_a ? pair.a.faces[axis.a].normal : pair.b.faces[axis.b].normal;
  manifold.owner = of_a ? NormalOwner::face_of_a : NormalOwner::face_of_b;
  manifold.normal = of_a ? -n : pair.b_to_a.direction(n);
  const double reference_radius = of_a ? pair.a.radius : pair.b.radius;
  const double incident_radius = of_a ? pair.b.radius : pair.a.radius;
  const FrameChange& to_incident = of_a ? pair.a_to_b : pair.b_to_a;
  for (int i = 0; i < points.size(); ++i) {
    const ContactPoint& p = points[i];
    const Vec3d on_reference = p.point + n * (reference_radius - p.height);
    const Vec3d on_incident = to_incident.point(p.point - n * incident_radius);
    ManifoldPoint& out = manifold.points[static_cast<std::size_t>(manifold.count++)];
    out.on_a = of_a ? on_reference : on_incident;
    out.on_b = of_a ? on_incident : on_reference;
    out.separation = p.height - pair.rounding();
    out.feature = p.feature;
  }
}

double lowest_of(const ContactPoints& points) {
  double lowest = std::numeric_limits<double>::infinity();
  for (int i = 0; i < points.size(); ++i) lowest = std::min(lowest, points[i].height);
  return lowest;
}

/// The lowest vertex of the incident shape, for a shape that penetrates although clipping leaves no point of it.
void take_lowest_vertex(const ShapePair& pair, const Axis& axis, ContactPoints& points) {
  const bool of_a = axis.kind == Kind::face_of_a;
  const ConvexFace& face = of_a ? pair.a.faces[axis.a] : pair.b.faces[axis.b];
  const FrameChange& change = of_a ? pair.b_to_a : pair.a_to_b;
  const ConvexView& incident = of_a ? pair.b : pair.a;
  const std::uint32_t v = lowest_vertex(incident.vertices, change.back(face.normal)).vertex;
  const std::uint32_t feature =
      of_a ? feature_id(FeatureKind::vertex_of_b, 0, v) : feature_id(FeatureKind::vertex_of_a, v, 0);
  points.push_back({change.point(incident.vertices[v]), axis.separation, feature});
}

/// The contact points of a face. False if the shapes are apart, and other features than the face are nearer.
bool find_face_points(const ShapePair& pair, const Axis& axis, bool apart, LastPoints& last,
                      Manifold& manifold) {
  const bool of_a = axis.kind == Kind::face_of_a;
  const ReferenceFace reference{of_a ? &pair.a : &pair.b, of_a ? axis.a : axis.b, of_a};
  ContactPoints points;
  clip_against(reference, of_a ? pair.b : pair.a, of_a ? pair.b_to_a : pair.a_to_b, pair.slack, pair.limit(),
               points);
  if (apart && lowest_of(points) > axis.separation + pair.slack) return false;
  if (points.size() == 0) {
    if (apart || pair.region != nullptr) return false;
    take_lowest_vertex(pair, axis, points);
  }
  reduce_to_four(points, reference.shape->faces[reference.face].normal, pair.slack, last);
  add_face_points(pair, axis, points, manifold);
  return true;
}

/// The contact point of two edges. False if their lines are nearest beyond an end, unless the shapes penetrate.
bool find_edge_point(const ShapePair& pair, const Axis& axis, bool apart, Manifold& manifold) {
  const ConvexEdge &edge_a = pair.a.edges[axis.a], &edge_b = pair.b.edges[axis.b];
  const Vec3d a0 = pair.a.vertices[edge_a.from], a1 = pair.a.vertices[edge_a.to];
  const Vec3d b0 = pair.b_to_a.point(pair.b.vertices[edge_b.from]),
              b1 = pair.b_to_a.point(pair.b.vertices[edge_b.to]);
  double s = 0, t = 0;
  nearest_on_edges(a0, a1, b0, b1, s, t);
  const Vec3d on_a = a0 + (a1 - a0) * s, on_b = b0 + (b1 - b0) * t;
  const Vec3d aside = on_b - on_a - axis.direction * axis.separation;
  const double allowed = 1e-6 * std::min(pair.a.outer_radius, pair.b.outer_radius);
  if ((apart || pair.region != nullptr) && length_squared(aside) > allowed * allowed) return false;
  add_point(pair, on_a, on_b, axis.direction, feature_id(FeatureKind::edges, axis.a, axis.b), manifold);
  return true;
}

Vec3d direction_of(const ShapePair& pair, const Axis& axis) {
  if (axis.kind == Kind::face_of_a) return pair.a.faces[axis.a].normal;
  if (axis.kind == Kind::face_of_b) return -pair.b_to_a.direction(pair.b.faces[axis.b].normal);
  return axis.direction;
}

/// The longest edge of a shape that is nearly perpendicular to an axis and touches the shape's supporting plane.
/// Returns its index, or no_face.
std::uint32_t supporting_edge(const ConvexView& shape, const Vec3d& axis) {
  constexpr double most_sine = 0.01;
  const double lowest = lowest_vertex(shape.vertices, axis).height;
  std::uint32_t best = no_face;
  double longest = 0;
  for (std::uint32_t e = 0; e < shape.edges.size(); ++e) {
    const Vec3d from = shape.vertices[shape.edges[e].from], to = shape.vertices[shape.edges[e].to];
    const double l = length(to - from), allowed = lowest + most_sine * l;
    if (l > longest && dot(from, axis) <= allowed && dot(to, axis) <= allowed) best = e, longest = l;
  }
  return best;
}

/// Two points, where the closest points lie on parallel edges.
bool find_parallel_edges(const ShapePair& pair, const Vec3d& axis, Manifold& manifold) {
  const std::uint32_t a = supporting_edge(pair.a, -axis);
  if (a == no_face) return false;
  const std::uint32_t b = supporting_edge(pair.b, pair.b_to_a.back(axis));
  if (b == no_face) return false;
  const ConvexEdge &edge_a = pair.a.edges[a], &edge_b = pair.b.edges[b];
  const Segment on_a{pair.a.vertices[edge_a.from], pair.a.vertices[edge_a.to]};
  const Segment on_b{pair.b_to_a.point(pair.b.vertices[edge_b.from]),
                     pair.b_to_a.point(pair.b.vertices[edge_b.to])};
  return add_parallel_segments(pair, on_a, on_b, axis, feature_id(FeatureKind::other, a, 2 * b), manifold);
}

/// The overlap [m] with which shapes still pass each other: 1 % of the smaller inner radius. A triangle has none.
double grazing(const ShapePair& pair) {
  const double a = pair.a.inner_radius + pair.a.radius, b = pair.b.inner_radius + pair.b.radius;
  return 0.01 * (b > 0 ? std::min(a, b) : a);
}

/// By how much the motion reduces the separation along a unit axis from a to b [m].
double approach(const ShapePair& pair, const Vec3d& axis) {
  return dot(pair.motion.path, axis) + length(cross(pair.motion.turn, axis)) * pair.a.outer_radius;
}

/// A face along whose normal the shapes stay apart, or overlap by no more than they may when they pass, although they
/// approach along `axis`.
Axis passing_face(const ShapePair& pair, const Vec3d& axis) {
  constexpr double like = 0.9;  // product of normals of one contact
  const double least = -grazing(pair) + pair.rounding();
  Axis best;
  const auto consider = [&](const Axis& face) {
    const Vec3d n = direction_of(pair, face);
    if (dot(n, axis) > like || !admits(pair, face)) return;
    if (face.separation - std::max(0.0, approach(pair, n)) >= least && face.separation > best.separation)
      best = face;
  };
  for (std::uint32_t f = 0; f < pair.a.faces.size(); ++f)
    consider(of_face(face_axis(pair.a, pair.b, pair.b_to_a, f), Kind::face_of_a));
  for (std::uint32_t f = 0; f < pair.b.faces.size(); ++f)
    consider(of_face(face_axis(pair.b, pair.a, pair.a_to_b, f), Kind::face_of_b));
  return best;
}

/// Removes points at which the shapes would meet if they did not pass each other. Points of the face on which one passes
/// the other take their place.
void drop_grazed(const ShapePair& pair, LastPoints& last, Manifold& manifold) {
  if (manifold.count == 0) return;
  const Vec3d axis = -manifold.normal;
  const double graze = grazing(pair), way = dot(pair.motion.path, axis);
  if (way <= 0.1 * graze) return;  // at rest
  double separation = std::numeric_limits<double>::infinity();
  for (int k = 0; k < manifold.count; ++k)
    separation = std::min(separation, manifold.points[static_cast<std::size_t>(k)].separation);
  if (separation < -graze || separation > way) return;
  const Axis face = passing_face(pair, axis);
  if (face.kind == Kind::none) return;
  manifold = {};
  manifold.passes = true;
  find_face_points(pair, face, true, last, manifold);
}

/// The contact points of two shapes that are apart.
void find_closest_point(const ShapePair& pair, const Axis& axis, AxisCache& cache, Manifold& manifold) {
  const ClosestPoints closest = closest_points(pair.a, pair.b, pair.b_to_a, direction_of(pair, axis));
  cache = {Kind::closest_points, 0, 0, closest.axis, {}};
  if (closest.distance >= pair.limit()) return;
  if (pair.region != nullptr && !pair.region->admits(-closest.axis)) return;
  if (find_parallel_edges(pair, closest.axis, manifold)) return;
  add_point(pair, closest.on_a, closest.on_b, closest.axis, closest.feature, manifold);
}

}  // namespace

ShapePair make_pair(const ConvexView& a, const ConvexView& b, const FrameChange& b_to_a, double margin,
                    const PairMotion& motion) {
  ShapePair pair{
      .a = a, .b = b, .b_to_a = b_to_a, .a_to_b = inverse(b_to_a), .margin = margin, .motion = motion};
  const bool has_sphere = a.vertices.size() == 1 || b.vertices.size() == 1;
  pair.slack = (has_sphere ? 1e-12 : 5e-4) * std::min(a.outer_radius, b.outer_radius);
  return pair;
}

void add_point(const ShapePair& pair, const Vec3d& core_a, const Vec3d& core_b, const Vec3d& axis,
               std::uint32_t feature, Manifold& manifold) {
  manifold.owner = NormalOwner::edges;
  manifold.normal = -axis;
  ManifoldPoint& out = manifold.points[static_cast<std::size_t>(manifold.count++)];
  out.on_a = core_a + axis * pair.a.radius;
  out.on_b = pair.a_to_b.point(core_b - axis * pair.b.radius);
  out.separation = dot(core_b - core_a, axis) - pair.rounding();
  out.feature = feature;
}

namespace {

void find_all_points(const ShapePair& pair, AxisCache& cache, Manifold& manifold) {
  Axis cached = cached_face(pair, cache);
  if (separates(pair, cache, cached)) return;
  if (!admits(pair, cached)) cached = {};
  const Axis axis = choose_axis(pair, cached);
  remember(cache, axis);
  if (axis.kind == Kind::none || axis.separation >= pair.limit()) return;
  const double touching = 1e-8 * std::min(pair.a.outer_radius, pair.b.outer_radius);
  const bool apart = axis.separation > touching;
  const bool found = axis.kind == Kind::edges ? find_edge_point(pair, axis, apart, manifold)
                                              : find_face_points(pair, axis, apart, cache.points, manifold);
  if (found) return;
  if (apart) {
    find_closest_point(pair, axis, cache, manifold);
  } else if (axis.kind == Kind::edges) {  // the region excludes the axis along which the edges are nearest
    const Axis face = best_face(pair, {});
    if (face.kind != Kind::none) find_face_points(pair, face, false, cache.points, manifold);
  }
}

}  // namespace

void find_points(const ShapePair& pair, AxisCache& cache, Manifold& manifold) {
  find_all_points(pair, cache, manifold);
  drop_grazed(pair, cache.points, manifold);
}

}  // namespace souple::manifold
