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
  std::uint32_t vertex;  // of the incident shape, if neither side is a plane
};
using Polygon = StackList<ClipVertex, ContactPoints::capacity>;

std::uint32_t most_opposed_face(const ConvexView& shape, const Vec3d& normal) {
  std::uint32_t best = 0;
  double least = dot(shape.faces[0].normal, normal);
  for (std::uint32_t f = 1; f < shape.faces.size(); ++f) {
    const double product = dot(shape.faces[f].normal, normal);
    if (product < least) best = f, least = product;
  }
  return best;
}

void start_polygon(const ConvexView& incident, const FrameChange& incident_to_reference, const Vec3d& normal,
                   Polygon& polygon) {
  const std::uint32_t face = most_opposed_face(incident, incident_to_reference.back(normal));
  std::uint32_t in = incident.corners_of(incident.faces[face]).back().edge;
  for (const ConvexCorner& corner : incident.corners_of(incident.faces[face])) {
    const Vec3d point = incident_to_reference.point(incident.vertices[corner.vertex]);
    polygon.push_back({point, in, corner.edge, corner.vertex});
    in = corner.edge;
  }
}

/// Whether a side plane cuts the polygon; if not, there is nothing to copy.
bool cuts(const Polygon& polygon, const Vec3d& normal, double offset) {
  for (int i = 0; i < polygon.size(); ++i) {
    if (dot(normal, polygon[i].point) > offset) return true;
  }
  return false;
}

void clip(const Polygon& polygon, const Vec3d& normal, double offset, std::uint32_t side, Polygon& out) {
  out.clear();
  const int count = polygon.size();
  double here = dot(normal, polygon[0].point) - offset;
  for (int i = 0; i < count; ++i) {
    const ClipVertex &from = polygon[i], &to = polygon[i + 1 < count ? i + 1 : 0];
    const double ahead = dot(normal, to.point) - offset;
    if (here <= 0) out.push_back(from);
    if ((here <= 0) != (ahead <= 0)) {
      const Vec3d point = from.point + (to.point - from.point) * (here / (here - ahead));
      if (here <= 0) {
        out.push_back({point, from.out, side, 0});
      } else {
        out.push_back({point, side, from.out, 0});
      }
    }
    here = ahead;
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
  const bool in_plane = (v.in & plane) != 0, out_plane = (v.out & plane) != 0;
  if (in_plane && out_plane) return plane_pair(reference, v.in & ~plane, v.out & ~plane);
  if (in_plane) return edge_pair(reference, v.in, v.out);
  if (out_plane) return edge_pair(reference, v.out, v.in);
  return vertex_of_incident(reference, v.vertex);
}

void clip_polygon(const ReferenceFace& reference, const ConvexView& incident,
                  const FrameChange& incident_to_reference, double tolerance, double limit,
                  ContactPoints& points) {
  const ConvexFace& face = reference.shape->faces[reference.face];
  Polygon first, second;
  Polygon *polygon = &first, *other = &second;
  start_polygon(incident, incident_to_reference, face.normal, *polygon);
  for (std::uint32_t c = face.begin; c < face.end; ++c) {
    const ConvexCorner& corner = reference.shape->corners[c];
    const double offset = corner.side_offset + tolerance;
    if (!cuts(*polygon, corner.side_normal, offset)) continue;
    clip(*polygon, corner.side_normal, offset, c | plane, *other);
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
                  const FrameChange& incident_to_reference, double tolerance, double limit,
                  ContactPoints& points) {
  const ConvexFace& face = reference.shape->faces[reference.face];
  const auto last = static_cast<std::uint32_t>(incident.vertices.size()) - 1;
  const Vec3d from = incident_to_reference.point(incident.vertices[0]);
  const Vec3d along = incident_to_reference.point(incident.vertices[last]) - from;
  double parameter[2] = {0, last == 0 ? 0.0 : 1.0};
  std::uint32_t feature[2] = {vertex_of_incident(reference, 0), vertex_of_incident(reference, last)};
  for (std::uint32_t c = face.begin; c < face.end; ++c) {
    const ConvexCorner& corner = reference.shape->corners[c];
    const double at_from = dot(corner.side_normal, from) - corner.side_offset - tolerance;
    const double slope = dot(corner.side_normal, along);
    if (at_from + slope * parameter[0] > 0) {
      if (!(slope < 0)) return;
      parameter[0] = -at_from / slope, feature[0] = edge_pair(reference, c, 0);
    }
    if (at_from + slope * parameter[1] > 0) {
      if (!(slope > 0)) return;
      parameter[1] = -at_from / slope, feature[1] = edge_pair(reference, c, 0);
    }
    if (parameter[0] > parameter[1]) return;
  }
  for (std::uint32_t k = 0; k <= last; ++k) {
    const Vec3d point = from + along * parameter[k];
    const double height = dot(face.normal, point) - face.offset;
    if (height < limit) points.push_back({point, height, feature[k]});
  }
}

}  // namespace

void clip_against(const ReferenceFace& reference, const ConvexView& incident,
                  const FrameChange& incident_to_reference, double tolerance, double limit,
                  ContactPoints& points) {
  if (incident.faces.empty()) {
    clip_segment(reference, incident, incident_to_reference, tolerance, limit, points);
  } else {
    clip_polygon(reference, incident, incident_to_reference, tolerance, limit, points);
  }
}

}  // namespace souple::manifold
