#include "souple/objects/import_particles.h"

#include "souple/assert.h"
#include "souple/error.h"
#include "souple/geometry/mesh_report.h"
#include "souple/geometry/reorder.h"
#include "souple/geometry/tet_mesh.h"
#include "souple/geometry/weld.h"
#include "souple/math/fnv1a.h"
#include "souple/math/limits.h"
#include "souple/objects/object.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include <fmt/core.h>

namespace souple {
namespace {

/// Imports particles in the order of a space-filling curve; sets particle_of and vertex_of accordingly.
void import_particles(Object& object, std::vector<Vec3d> rest, const std::vector<std::uint32_t>& to_particle,
                      const std::vector<std::uint32_t>& to_vertex) {
  const std::vector<std::uint32_t> order = morton_order(rest);  // order[new] = old
  std::vector<std::uint32_t> new_of(order.size());
  for (std::uint32_t i = 0; i < order.size(); ++i) new_of[order[i]] = i;
  for (const std::uint32_t old : order) {
    object.rest.push_back(rest[old]);
    object.vertex_of.push_back(to_vertex[old]);
  }
  for (const std::uint32_t old : to_particle) object.particle_of.push_back(new_of[old]);
  SOUPLE_ASSERT(object.vertex_of.size() == object.rest.size(), "one vertex per particle");
}

}  // namespace

void transform_points(std::vector<Vec3d>& points, const Transform& transform, const std::string& name) {
  for (std::size_t i = 0; i < points.size(); ++i) {
    points[i] = transform.point(points[i]);
    if (!is_within(points[i], range::coordinate))
      throw Error(fmt::format("{}: vertex {} is not finite, or more than {:g} m from the origin", name, i,
                              range::coordinate));
  }
}

void place(TriangleMesh& mesh, const Transform& transform, const std::string& name) {
  transform_points(mesh.positions, transform, name);
  for (Vec3f& normal : mesh.appearance.normals) normal = Vec3f(rotate(transform.rotation, Vec3d(normal)));
}

std::vector<std::uint32_t> identity(std::size_t count) {
  std::vector<std::uint32_t> result(count);
  std::iota(result.begin(), result.end(), 0u);
  return result;
}

void require_apart(std::span<const Vec3d> points, double width, const std::string& name) {
  constexpr std::size_t limit = 100;
  if (points.size() <= limit) return;
  std::vector<std::pair<std::uint64_t, std::size_t>> cubes;  // hash of each point's cube, point
  cubes.reserve(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    double cube[3];
    for (int k = 0; k < 3; ++k) cube[k] = std::floor(points[i][k] / width) + 0.0;  // without -0
    cubes.emplace_back(fnv1a64(std::as_bytes(std::span(cube))), i);
  }
  std::sort(cubes.begin(), cubes.end());
  for (std::size_t begin = 0, end = 0; begin < cubes.size(); begin = end) {
    while (end < cubes.size() && cubes[end].first == cubes[begin].first) ++end;
    if (end - begin > limit)
      throw Error(
          fmt::format("{}: {} of its points are in one cube of {:.3g} m, the width of a particle (the first "
                      "is number {}); at most {} may be: spread them, or use smaller particles",
                      name, end - begin, width, cubes[begin].second, limit));
  }
}

void import_points(Object& object, std::vector<Vec3d> points) {
  object.rest = std::move(points);
  object.particle_of = object.vertex_of = identity(object.rest.size());
}

void import_surface(NewObject& made, const TriangleMesh& mesh, const Transform& transform) {
  Object& object = *made.object;
  check_indices(mesh, object.name.c_str());
  object.mesh = mesh;
  place(object.mesh, transform, object.name);
  const RepairedSurface repaired = repair(object.mesh);
  made.sentences = repaired.sentences;
  const Weld& weld = repaired.weld;
  import_particles(object, gather<Vec3d>(weld, object.mesh.positions), weld.to_welded, weld.to_vertex);
  if (repaired.source != identity(object.mesh.triangles.size())) object.triangle_source = repaired.source;
  for (const Triangle& triangle : repaired.triangles)
    object.surface.push_back({object.particle_of[weld.to_vertex[triangle[0]]],
                              object.particle_of[weld.to_vertex[triangle[1]]],
                              object.particle_of[weld.to_vertex[triangle[2]]]});
}

void import_tets(Object& object, const TetMesh& mesh) {
  import_particles(object, mesh.positions, identity(mesh.positions.size()), identity(mesh.positions.size()));
  object.tets.positions = object.rest;
  for (Tet tet : mesh.tets) {
    for (std::uint32_t& i : tet) i = object.particle_of[i];
    object.tets.tets.push_back(tet);
  }
}

void fill_missing_masses(std::vector<double>& mass, const std::string& name) {
  if (mass.empty()) throw Error(name + ": there are no vertices");
  double smallest = 0;
  for (const double m : mass)
    if (m > 0 && (smallest == 0 || m < smallest)) smallest = m;
  if (!(smallest > 0)) throw Error(name + ": its elements have no area or volume, so it has no mass");
  for (double& m : mass)
    if (!(m > 0)) m = smallest;
}

}  // namespace souple
