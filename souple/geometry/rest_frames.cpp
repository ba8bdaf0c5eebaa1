#include "souple/geometry/rest_frames.h"

#include "souple/error.h"
#include "souple/geometry/adjacency.h"

#include <cmath>
#include <string>

#include <fmt/core.h>

namespace souple {
namespace {

using CornerUvs = std::array<std::array<float, 2>, 3>;

[[noreturn]] void throw_mismatch(const std::string& what) {
  throw Error("the mesh's UVs do not fit its faces: " + what);
}

// Triangles are fans of faces: corners (0, i + 1, i + 2) of a face.
std::vector<CornerUvs> fan_uvs(const TriangleMesh& mesh) {
  std::vector<CornerUvs> result;
  result.reserve(mesh.triangles.size());
  for (const std::vector<std::uint32_t>& face : mesh.face_uvs) {
    for (const std::uint32_t uv : face)
      if (uv >= mesh.uvs.size()) throw_mismatch(fmt::format("UV index {} of {}", uv, mesh.uvs.size()));
    for (std::size_t i = 0; i + 2 < face.size(); ++i)
      result.push_back({mesh.uvs[face[0]], mesh.uvs[face[i + 1]], mesh.uvs[face[i + 2]]});
  }
  if (result.size() != mesh.triangles.size())
    throw_mismatch(fmt::format("{} triangles with UVs of {}", result.size(), mesh.triangles.size()));
  return result;
}

// Direction of increasing U: x(u, v) is linear on the triangle, so e1 = x_u du1 + x_v dv1 and e2 = x_u du2 +
// x_v dv2, hence x_u = (e1 dv2 - e2 dv1) / det. Zero if the UVs have no area.
Vec3d u_direction(const CornerUvs& uv, const Vec3d& e1, const Vec3d& e2) {
  const double du1 = double(uv[1][0]) - double(uv[0][0]), dv1 = double(uv[1][1]) - double(uv[0][1]);
  const double du2 = double(uv[2][0]) - double(uv[0][0]), dv2 = double(uv[2][1]) - double(uv[0][1]);
  const double det = du1 * dv2 - du2 * dv1;
  const double scale = du1 * du1 + dv1 * dv1 + du2 * du2 + dv2 * dv2;
  if (!(std::abs(det) > 1e-6 * scale)) return {};
  return normalized((e1 * dv2 - e2 * dv1) * (det > 0 ? 1.0 : -1.0));
}

Vec3d laid_into_plane(const Vec3d& direction, const Vec3d& normal) {
  const Vec3d unit = normalized(direction);
  const Vec3d flat = unit - normal * dot(unit, normal);
  return length(flat) > 1e-6 ? normalized(flat) : Vec3d{};
}

}  // namespace

std::optional<std::vector<CornerUvs>> triangle_uvs(const TriangleMesh& mesh) {
  if (mesh.uvs.empty()) return std::nullopt;
  if (!mesh.face_uvs.empty()) return fan_uvs(mesh);
  if (mesh.uvs.size() != mesh.positions.size())
    throw_mismatch(fmt::format("{} UVs for {} vertices, and no UV indices of faces", mesh.uvs.size(),
                               mesh.positions.size()));
  check_indices(mesh);
  std::vector<CornerUvs> result;
  result.reserve(mesh.triangles.size());
  for (const Triangle& t : mesh.triangles) result.push_back({mesh.uvs[t[0]], mesh.uvs[t[1]], mesh.uvs[t[2]]});
  return result;
}

std::vector<RestFrame> rest_frames(const TriangleMesh& mesh, const Vec3d& fallback) {
  check_indices(mesh);
  const auto uvs = triangle_uvs(mesh);
  std::vector<RestFrame> frames(mesh.triangles.size());
  for (std::size_t t = 0; t < frames.size(); ++t) {
    const Vec3d a = mesh.positions[mesh.triangles[t][0]];
    const Vec3d e1 = mesh.positions[mesh.triangles[t][1]] - a, e2 = mesh.positions[mesh.triangles[t][2]] - a;
    const Vec3d normal = normalized(cross(normalized(e1), normalized(e2)));
    if (!(length_squared(normal) > 0)) continue;
    Vec3d warp = uvs ? u_direction((*uvs)[t], e1, e2) : Vec3d{};
    if (warp == Vec3d{}) warp = laid_into_plane(fallback, normal);
    if (warp == Vec3d{}) warp = normalized(e1);
    frames[t] = {warp, cross(normal, warp)};
  }
  return frames;
}

FlatTriangle flatten(const RestFrame& frame, const Vec3d& a, const Vec3d& b, const Vec3d& c) {
  return {{dot(b - a, frame.warp), dot(b - a, frame.weft)}, {dot(c - a, frame.warp), dot(c - a, frame.weft)}};
}

}  // namespace souple
