#include "souple/world/fluid_boundary.h"

#include "souple/geometry/adjacency.h"
#include "souple/objects/object.h"
#include "souple/world/add.h"

#include <algorithm>
#include <cmath>
#include <map>

namespace souple {

namespace {

constexpr std::size_t max_triangles = 40000;  // of a subdivided surface

double longest_edge(const TriangleMesh& mesh) {
  double longest = 0;
  for (const Triangle& t : mesh.triangles)
    for (std::size_t k = 0; k < 3; ++k)
      longest = max(longest, length(mesh.positions[t[k]] - mesh.positions[t[(k + 1) % 3]]));
  return longest;
}

/// Divides each triangle into four at the midpoints of its edges.
TriangleMesh halved(const TriangleMesh& mesh) {
  TriangleMesh result;
  result.positions = mesh.positions;
  std::map<Edge, std::uint32_t> middles;
  const auto middle = [&](std::uint32_t a, std::uint32_t b) {
    const auto [at, made] = middles.try_emplace(Edge{std::min(a, b), std::max(a, b)},
                                                static_cast<std::uint32_t>(result.positions.size()));
    if (made) result.positions.push_back((mesh.positions[a] + mesh.positions[b]) * 0.5);
    return at->second;
  };
  for (const auto& [a, b, c] : mesh.triangles) {
    const std::uint32_t ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
    for (const Triangle& t :
         {Triangle{a, ab, ca}, Triangle{ab, b, bc}, Triangle{ca, bc, c}, Triangle{ab, bc, ca}})
      result.triangles.push_back(t);
  }
  return result;
}

// A push on a triangle acts on the tets that contain its corners. With large triangles, such as the twelve of
// a box, these corners would bear all of it. So triangles are divided until no edge is longer than three
// spacings.
BoundaryMesh embedded_boundary(const Object& object, float spacing) {
  TriangleMesh mesh;
  mesh.positions = object.mesh.positions;
  mesh.triangles = object.mesh.triangles;
  while (longest_edge(mesh) > 3 * static_cast<double>(spacing) && 4 * mesh.triangles.size() <= max_triangles)
    mesh = halved(mesh);
  const Embedding embedding = embed(mesh.positions, object.tets);
  BoundaryMesh boundary;
  boundary.triangles = mesh.triangles;
  for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
    auto& particles = boundary.particles.emplace_back();
    auto& weights = boundary.weights.emplace_back();
    for (std::size_t k = 0; k < 4; ++k) {
      particles[k] = object.begin + embedding.vertices[v][k];
      weights[k] = static_cast<float>(embedding.weights[v][k]);
    }
  }
  return boundary;
}

BoundaryMesh particle_boundary(const Object& object) {
  BoundaryMesh boundary;
  boundary.triangles = object.surface;
  for (std::uint32_t i = object.begin; i < object.end; ++i) {
    boundary.particles.push_back({i, i, i, i});
    boundary.weights.push_back({1, 0, 0, 0});
  }
  return boundary;
}

/// Points in a ball, about a spacing apart; its center if it is smaller.
std::vector<Vec3f> points_in_ball(float radius, float spacing) {
  constexpr float max_points_across = 10;
  if (radius < spacing) return {Vec3f{}};
  std::vector<Vec3f> result;
  const float across = std::ceil(min(2 * radius / spacing, max_points_across)), pitch = 2 * radius / across;
  for (float z = 0.5f; z < across; ++z)
    for (float y = 0.5f; y < across; ++y)
      for (float x = 0.5f; x < across; ++x) {
        const Vec3f at = Vec3f{x, y, z} * pitch - Vec3f{radius, radius, radius};
        if (dot(at, at) < radius * radius) result.push_back(at);
      }
  return result;
}

// The points of a large grain have in total its cross section, which determines the drag.
void append_grains(const Object& object, float spacing, float radius, std::span<const float> mass,
                   std::uint32_t number, std::vector<SubResolutionBody>& bodies) {
  const std::vector<Vec3f> points = points_in_ball(radius, spacing);
  const float part = 1 / static_cast<float>(points.size());
  const float volume = 4 * static_cast<float>(pi) / 3 * radius * radius * radius;
  for (std::uint32_t i = object.begin; i < object.end; ++i)
    for (const Vec3f& point : points)
      bodies.push_back({.particles = {i, i},
                        .weights = {1, 0},
                        .offset = point,
                        .volume = volume * part,
                        .mass = mass[i] * part,
                        .radius = radius * std::sqrt(part),
                        .object = number});
}

// Pieces no longer than the spacing, each at the midpoint of its part of a segment.
void append_rope(const Object& object, float spacing, float radius, std::span<const float> mass,
                 std::uint32_t number, std::vector<SubResolutionBody>& bodies) {
  constexpr double max_pieces = 64;  // per segment
  double all = 0, weight = 0;
  for (std::uint32_t i = object.begin; i < object.end; ++i) weight += static_cast<double>(mass[i]);
  for (std::size_t i = 0; i + 1 < object.rest.size(); ++i) all += length(object.rest[i + 1] - object.rest[i]);
  for (std::uint32_t i = 0; i + 1 < object.particle_count(); ++i) {
    const double segment = length(object.rest[i + 1] - object.rest[i]);
    const double pieces = min(std::ceil(max(segment / static_cast<double>(spacing), 1.0)), max_pieces);
    const auto piece = static_cast<float>(segment / pieces);
    for (double k = 0.5; k < pieces; ++k) {
      const auto t = static_cast<float>(k / pieces);
      bodies.push_back({.particles = {object.begin + i, object.begin + i + 1},
                        .weights = {1 - t, t},
                        .volume = static_cast<float>(pi) * radius * radius * piece,
                        .mass = static_cast<float>(weight / all) * piece,
                        .radius = radius,
                        .length = piece,
                        .object = number});
    }
  }
}

}  // namespace

void append_sub_resolution_bodies(const Object& object, float spacing, std::span<const float> mass,
                                  std::uint32_t number, std::vector<SubResolutionBody>& bodies) {
  const float radius = contact_radius(object.material);
  if (object.kind == ObjectKind::grains) append_grains(object, spacing, radius, mass, number, bodies);
  if (object.kind == ObjectKind::rope) append_rope(object, spacing, radius, mass, number, bodies);
}

std::optional<BoundaryMesh> boundary_mesh_of(const Object& object, float spacing) {
  if (object.kind == ObjectKind::fluid || (!object.embedding && object.surface.empty())) return std::nullopt;
  BoundaryMesh boundary = object.embedding ? embedded_boundary(object, spacing) : particle_boundary(object);
  const bool solid = object.kind == ObjectKind::soft_body;
  boundary.begin = object.begin;
  boundary.end = object.end;
  boundary.half_thickness = contact_radius(object.material);
  boundary.closed = solid;
  boundary.compliance = solid ? BodyCompliance::per_body : BodyCompliance::per_vertex;
  return boundary;
}

}  // namespace souple
