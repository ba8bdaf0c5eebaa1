#include "souple/rigid/manifold_clip.h"

#include <algorithm>

namespace souple::manifold {
namespace {

/// A corner of the clipped polygon, between two sides. A side is an edge of the incident shape, or a side plane of the
/// reference face: its corner's index with the flag `plane`.
constexpr std::uint32_t plane = std::uint32_t(1) << 31;

struct ClipVertex {
  Vec3d point;
  std::uint32_t in, out;
  std::uint32_t vertex;  // of the incident shape, or no_vertex
};
constexpr std::uint32_t no_vertex = ~std::uint32_t(0);
using Polygon = StackList<ClipVertex, ContactPoints::capacity>;

/// The face that opposes the normal most, among those at the lowest vertex. On a skew polyhedron, a face elsewhere may
/// oppose the normal more.
std::uint32_t opposing_face(const ConvexView& shape, const Vec3d& normal) {
  const Vec3d lowest = shape.vertices[lowest_vertex(shape.vertices, normal).vertex];
  const double rounding = 1e-6 * shape.outer_radius;
  std::uint32_t best = 0;
  double least = 2;
  for (std::uint32_t f = 0; f < shape.faces.size(); ++f) {
    const ConvexFace& face = shape.faces[f];
    const double product = dot(face.normal, normal);
    if (product < least && dot(face.normal, lowest) >= face.offset - rounding) best = f, least = product;
  }
  return best;
}

void start_polygon(const ConvexView& incident, const FrameChange& incident_to_reference, const Vec3d& normal,
                   Polygon& polygon) {
  const std::uint32_t face = opposing_face(incident, incident_to_reference.back(normal));
  std::uint32_t in = incident.corners_of(incident.faces[face]).back().edge;
  for (const ConvexCorner& corner : incident.corners_of(incident.faces[face])) {
    const Vec3d point = incident_to_reference.point(incident.vertices[corner.vertex]);
    polygon.push_back({point, in, corner.edge, corner.vertex});
    in = corner.edge;
  }
}

/// A side plane of the reference face. Points up to `slack` beyond it count as inside.
struct SidePlane {
  Vec3d normal;
  double offset, slack;
  std::uint32_t side;
};
using Distances = StackList<double, ContactPoints::capacity>;

/// Fills in the distances beyond a side plane. Whether it cuts the polygon; if not, there is nothing to copy.
bool cuts(const Polygon& polygon, const SidePlane& p, Distances& beyond) {
  bool any = false;
  beyond.clear();
  for (int i = 0; i < polygon.size(); ++i) {
    beyond.push_back(dot(p.normal, polygon[i].point) - p.offset);
    any = any || beyond[i] > p.slack;
  }
  return any;
}

Vec3d crossing(const ClipVertex& v, double beyond_v, const ClipVertex& w, double beyond_w) {
  return v.point + (w.point - v.point) * (beyond_v / (beyond_v - beyond_w));
}

/// A vertex within the slack remains, at its place, where another polygon would have the point at which its edge crosses
/// the plane.
void clip(const Polygon& polygon, const SidePlane& p, const Distances& beyond, Polygon& out) {
  out.clear();
  const int count = polygon.size();
  for (int i = 0; i < count; ++i) {
    const double here = beyond[i];
    if (here > p.slack) continue;
    const int before = i > 0 ? i - 1 : count - 1, after = i + 1 < count ? i + 1 : 0;
    const bool enters = beyond[before] > p.slack, leaves = beyond[after] > p.slack;
    ClipVertex v = polygon[i];
    if (enters && here <= 0) {
      const ClipVertex& w = polygon[before];
      out.push_back({crossing(v, here, w, beyond[before]), p.side, w.out, no_vertex});
    }
    if (enters && here > 0) v.in = p.side;
    if (leaves && here > 0) v.out = p.side;
    out.push_back(v);
    if (leaves && here <= 0) {
      out.push_back({crossing(v, here, polygon[after], beyond[after]), v.out, p.side, no_vertex});
    }
  }
}

std::uint32_t edge_pair(const ReferenceFace& reference, std::uint32_t corner, std::uint32_t incident_edge) {
  const std::uint32_t edge = reference.shape->corners[corner & ~plane].edge;
  return reference.is_of_a ? feature_id(FeatureKind::edges, edge, incident_edge)
                           : feature_id(FeatureKind::edges, incident_edge, edge);
}

std::uint32_t vertex_of_incident(const ReferenceFace& reference, std::uint32_t vertex) {
  return reference.is_of_a ? feature_id(FeatureKind::vertex_of_b, 0, vertex)
                           : feature_id(FeatureKind::vertex_of_a, vertex, 0);
}

/// The feature of the point where two side planes meet: a vertex of the reference face, if they are neighbors.
std::uint32_t plane_pair(const ReferenceFace& reference, std::uint32_t in, std::uint32_t out) {
  const ConvexFace& face = reference.shape->faces[reference.face];
  const auto next = [&](std::uint32_t corner) { return corner + 1 < face.end ? corner + 1 : face.begin; };
  if (next(out) != in && next(in) != out) return feature_id(FeatureKind::other, in, out);
  const std::uint32_t vertex = reference.shape->corners[next(out) == in ? in : out].vertex;
  return reference.is_of_a ? feature_id(FeatureKind::vertex_of_a, vertex, 0)
                           : feature_id(FeatureKind::vertex_of_b, 0, vertex);
}

std::uint32_t feature_of(const ReferenceFace& reference, const ClipVertex& v) {
  if (v.vertex != no_vertex) return vertex_of_incident(reference, v.vertex);
  const bool in_plane = (v.in & plane) != 0, out_plane = (v.out & plane) != 0;
  if (in_plane && out_plane) return plane_pair(reference, v.in & ~plane, v.out & ~plane);
  return in_plane ? edge_pair(reference, v.in, v.out) : edge_pair(reference, v.out, v.in);
}

void clip_polygon(const ReferenceFace& reference, const ConvexView& incident,
                  const FrameChange& incident_to_reference, double slack, double limit,
                  ContactPoints& points) {
  const ConvexFace& face = reference.shape->faces[reference.face];
  Polygon first, second;
  Distances beyond;
  Polygon *polygon = &first, *other = &second;
  start_polygon(incident, incident_to_reference, face.normal, *polygon);
  for (std::uint32_t c = face.begin; c < face.end; ++c) {
    const ConvexCorner& corner = reference.shape->corners[c];
    const SidePlane side{corner.side_normal, corner.side_offset, slack, c | plane};
    if (!cuts(*polygon, side, beyond)) continue;
    clip(*polygon, side, beyond, *other);
    std::swap(polygon, other);
    if (polygon->size() == 0) return;
  }
  for (int i = 0; i < polygon->size(); ++i) {
    const ClipVertex& v = (*polygon)[i];
    const double height = dot(face.normal, v.point) - face.offset;
    if (height < limit) points.push_back({v.point, height, feature_of(reference, v)});
  }
}

/// A segment or a point: the interval of the parameter within the side planes.
void clip_segment(const ReferenceFace& reference, const ConvexView& incident,
                  const FrameChange& incident_to_reference, double slack, double limit,
                  ContactPoints& points) {
  const ConvexFace& face = reference.shape->faces[reference.face];
  const auto last = static_cast<std::uint32_t>(incident.vertices.size()) - 1;
  const Vec3d from = incident_to_reference.point(incident.vertices[0]);
  const Vec3d along = incident_to_reference.point(incident.vertices[last]) - from;
  double parameter[2] = {0, last == 0 ? 0.0 : 1.0};
  std::uint32_t feature[2] = {vertex_of_incident(reference, 0), vertex_of_incident(reference, last)};
  for (std::uint32_t c = face.begin; c < face.end; ++c) {
    const ConvexCorner& corner = reference.shape->corners[c];
    const double at_from = dot(corner.side_normal, from) - corner.side_offset;
    const double slope = dot(corner.side_normal, along);
    const bool out_0 = at_from + slope * parameter[0] > slack, out_1 = at_from + slope * parameter[1] > slack;
    if (out_0 && out_1) return;
    if (out_0)
      parameter[0] = std::min(-at_from / slope, parameter[1]), feature[0] = edge_pair(reference, c, 0);
    if (out_1)
      parameter[1] = std::max(-at_from / slope, parameter[0]), feature[1] = edge_pair(reference, c, 0);
  }
  for (std::uint32_t k = 0; k <= last; ++k) {
    const Vec3d point = from + along * parameter[k];
    const double height = dot(face.normal, point) - face.offset;
    if (height < limit) points.push_back({point, height, feature[k]});
  }
}

}  // namespace

void clip_against(const ReferenceFace& reference, const ConvexView& incident,
                  const FrameChange& incident_to_reference, double slack, double limit,
                  ContactPoints& points) {
  if (incident.faces.empty()) {
    clip_segment(reference, incident, incident_to_reference, slack, limit, points);
  } else {
    clip_polygon(reference, incident, incident_to_reference, slack, limit, points);
  }
}

}  // namespace souple::manifold
