#include "souple/objects/fluid_boundary.h"

#include "souple/geometry/adjacency.h"
#include "souple/objects/kind_functions.h"
#include "souple/objects/object.h"

#include <algorithm>
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

}  // namespace

void append_sub_resolution_bodies(const Object& object, float spacing, std::span<const float> mass,
                                  std::uint32_t number, std::vector<SubResolutionBody>& bodies) {
  if (const auto append = functions_of(object.kind).append_sub_resolution_bodies)
    append(object.material, object, spacing, mass, number, bodies);
}

std::optional<BoundaryMesh> boundary_mesh_of(const Object& object, float spacing) {
  const KindTraits& kind = object.traits();
  if (kind.flows || (!object.embedding && object.surface.empty())) return std::nullopt;
  BoundaryMesh boundary = object.embedding ? embedded_boundary(object, spacing) : particle_boundary(object);
  const bool solid = kind.shape == ObjectShape::solid;
  boundary.begin = object.begin;
  boundary.end = object.end;
  boundary.half_thickness = contact_radius(object.material);
  boundary.closed = solid;
  boundary.compliance = solid ? BodyCompliance::per_body : BodyCompliance::per_vertex;
  return boundary;
}

}  // namespace souple
