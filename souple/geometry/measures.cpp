#include "souple/geometry/measures.h"

#include <algorithm>
#include <limits>

namespace souple {
namespace {

double area_of(std::span<const Vec3d> positions, const Triangle& t) {
  const Vec3d& a = positions[t[0]];
  return length(cross(positions[t[1]] - a, positions[t[2]] - a)) / 2;
}

double volume_of(const TetMesh& mesh, const Tet& t) {
  const Vec3d& a = mesh.positions[t[0]];
  return dot(cross(mesh.positions[t[1]] - a, mesh.positions[t[2]] - a), mesh.positions[t[3]] - a) / 6;
}

}  // namespace

BoundingBox bounding_box(std::span<const Vec3d> positions) {
  constexpr double big = std::numeric_limits<double>::max();
  BoundingBox box{{big, big, big}, {-big, -big, -big}};
  bool any = false;
  for (const Vec3d& p : positions) {
    if (!is_finite(p)) continue;
    any = true;
    for (int i = 0; i < 3; ++i) {
      box.lo[i] = std::min(box.lo[i], p[i]);
      box.hi[i] = std::max(box.hi[i], p[i]);
    }
  }
  return any ? box : BoundingBox{};
}

BoundingBox bounding_box(std::span<const Vec3d> positions, std::span<const Triangle> triangles) {
  std::vector<Vec3d> corners;
  corners.reserve(triangles.size() * 3);
  for (const Triangle& t : triangles)
    for (const std::uint32_t v : t) corners.push_back(positions[v]);
  return bounding_box(corners);
}

double surface_area(std::span<const Vec3d> positions, std::span<const Triangle> triangles) {
  double sum = 0;
  for (const Triangle& t : triangles) sum += area_of(positions, t);
  return sum;
}

double enclosed_volume(std::span<const Vec3d> positions, std::span<const Triangle> triangles) {
  if (triangles.empty()) return 0;
  // Tets from a vertex of the surface: with tets from the origin, a small body far away would lose precision.
  const Vec3d apex = positions[triangles[0][0]];
  double sum = 0;
  for (const Triangle& t : triangles)
    sum += dot(positions[t[0]] - apex, cross(positions[t[1]] - apex, positions[t[2]] - apex));
  return sum / 6;
}

std::vector<double> tet_volumes(const TetMesh& mesh) {
  std::vector<double> volumes;
  volumes.reserve(mesh.tets.size());
  for (const Tet& t : mesh.tets) volumes.push_back(volume_of(mesh, t));
  return volumes;
}

double tet_volume(const TetMesh& mesh) {
  double sum = 0;
  for (const Tet& t : mesh.tets) sum += volume_of(mesh, t);
  return sum;
}

std::vector<double> lumped_masses(std::span<const Vec3d> positions, std::span<const Triangle> triangles,
                                  double areal_density) {
  std::vector<double> masses(positions.size(), 0.0);
  for (const Triangle& t : triangles) {
    const double share = area_of(positions, t) * areal_density / 3;
    for (const std::uint32_t v : t) masses[v] += share;
  }
  return masses;
}

std::vector<double> lumped_masses(const TetMesh& mesh, double density) {
  std::vector<double> masses(mesh.positions.size(), 0.0);
  for (const Tet& t : mesh.tets) {
    const double share = volume_of(mesh, t) * density / 4;
    for (const std::uint32_t v : t) masses[v] += share;
  }
  return masses;
}

std::vector<Vec3d> vertex_normals(const TriangleMesh& mesh) {
  std::vector<Vec3d> normals(mesh.positions.size());
  vertex_normals<double>(mesh.positions, mesh.triangles, normals);
  return normals;
}

}  // namespace souple
