#include "souple/host/vertex_welder.h"

#include "souple/error.h"
#include "souple/geometry/adjacency.h"
#include "souple/geometry/measures.h"
#include "souple/geometry/weld.h"

#include <cmath>
#include <limits>
#include <utility>

#include <fmt/core.h>

namespace souple::host {

namespace {

void require_stride(std::size_t stride, const std::string& name) {
  if (stride < 3) throw Error(fmt::format("{}: the stride is {} floats, expected 3 or more", name, stride));
}

std::vector<Vec3d> read_positions(const TriangleSoup& soup, const std::string& name) {
  require_stride(soup.stride, name);
  if (soup.vertex_count > std::numeric_limits<std::uint32_t>::max())
    throw Error(name + ": more than 4294967295 vertices");
  if (soup.positions == nullptr && soup.vertex_count > 0) throw Error(name + ": there are no positions");
  std::vector<Vec3d> positions(soup.vertex_count);
  for (std::size_t v = 0; v < positions.size(); ++v) {
    const float* x = soup.positions + v * soup.stride;
    positions[v] = Vec3d(Vec3f(x[0], x[1], x[2]));
    if (!is_finite(positions[v]))
      throw Error(fmt::format("{}: the position of vertex {} is not finite", name, v));
  }
  return positions;
}

std::vector<Triangle> read_triangles(const TriangleSoup& soup, const std::string& name) {
  if (soup.triangle_count == 0 || soup.indices == nullptr)
    throw Error(name + ": there are no triangles, expected at least one");
  std::vector<Triangle> triangles(soup.triangle_count);
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    for (std::size_t k = 0; k < 3; ++k) triangles[t][k] = soup.indices[3 * t + k];
  }
  return triangles;
}

void put(const Vec3f& value, float* out) {
  out[0] = value.x, out[1] = value.y, out[2] = value.z;
}

}  // namespace

VertexWelder::VertexWelder(const TriangleSoup& soup, double tolerance, const std::string& name) {
  TriangleMesh mesh;
  mesh.triangles = read_triangles(soup, name);
  mesh.positions = read_positions(soup, name);
  check_indices(mesh, name.c_str());
  if (!(tolerance >= 0) || !std::isfinite(tolerance))
    throw Error(fmt::format("{}: the weld tolerance is {}, expected a finite length >= 0", name, tolerance));
  Weld weld = weld_vertices(mesh.positions, tolerance);
  positions_ = gather<Vec3d>(weld, mesh.positions);
  particle_of_ = std::move(weld.to_welded);
  render_triangles_ = std::move(mesh.triangles);
  triangles_ = render_triangles_;
  for (Triangle& triangle : triangles_)
    for (std::uint32_t& corner : triangle) corner = particle_of_[corner];
}

TriangleMesh VertexWelder::mesh(const Placement& placement) const {
  TriangleMesh mesh;
  mesh.positions.reserve(positions_.size());
  for (const Vec3d& x : positions_) mesh.positions.push_back(placement.to_world(x));
  mesh.triangles = triangles_;
  if (placement.mirrors())
    for (Triangle& triangle : mesh.triangles) std::swap(triangle[1], triangle[2]);
  return mesh;
}

void VertexWelder::write(const Vec3f* particles, const Placement& placement, const VertexBuffers& buffers,
                         Normals normals) {
  require_stride(buffers.stride, "vertex buffers");
  placed_.resize(particle_count());
  for (std::size_t i = 0; i < placed_.size(); ++i) placed_[i] = Vec3f(placement.to_mesh(Vec3d(particles[i])));
  if (buffers.positions != nullptr) {
    for (std::size_t v = 0; v < vertex_count(); ++v)
      put(placed_[particle_of_[v]], buffers.positions + v * buffers.stride);
  }
  if (buffers.normals != nullptr) write_normals(buffers, normals);
}

void VertexWelder::write_normals(const VertexBuffers& buffers, Normals normals) {
  const bool welded = normals == Normals::welded;
  normals_.assign(welded ? particle_count() : vertex_count(), {});
  for (std::size_t t = 0; t < triangles_.size(); ++t) {
    const Vec3f &a = placed_[triangles_[t][0]], &b = placed_[triangles_[t][1]],
                &c = placed_[triangles_[t][2]];
    const Vec3f n = cross(b - a, c - a);  // length: twice the area
    for (const std::uint32_t v : welded ? triangles_[t] : render_triangles_[t]) normals_[v] += n;
  }
  for (Vec3f& n : normals_) n = unit_normal(n);
  for (std::size_t v = 0; v < vertex_count(); ++v)
    put(normals_[welded ? particle_of_[v] : v], buffers.normals + v * buffers.stride);
}

}  // namespace souple::host
