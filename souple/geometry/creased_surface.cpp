#include "souple/geometry/creased_surface.h"

#include "souple/geometry/adjacency.h"
#include "souple/geometry/measures.h"
#include "souple/math/sentinels.h"

#include <algorithm>

namespace souple {
namespace {

constexpr double cosine_of_crease = 0.5;  // 60 degrees

std::vector<Vec3d> face_normals(std::span<const Vec3d> x, std::span<const Triangle> triangles) {
  std::vector<Vec3d> normals;
  normals.reserve(triangles.size());
  for (const Triangle& t : triangles)
    normals.push_back(normalized(cross(x[t[1]] - x[t[0]], x[t[2]] - x[t[0]])));
  return normals;
}

std::size_t corner_of(const Triangle& triangle, std::uint32_t vertex) {
  return static_cast<std::size_t>(std::find(triangle.begin(), triangle.end(), vertex) - triangle.begin());
}

/// Whether two triangles at a vertex share an edge there.
bool adjoin(const Triangle& a, const Triangle& b, std::uint32_t vertex) {
  return std::any_of(a.begin(), a.end(), [&](std::uint32_t v) {
    return v != vertex && std::find(b.begin(), b.end(), v) != b.end();
  });
}

/// The smooth part of each triangle in the fan around a vertex; parts are numbered from 0 in order of
/// appearance.
std::vector<std::uint32_t> smooth_parts(std::span<const Triangle> triangles, std::span<const Vec3d> normals,
                                        std::span<const std::uint32_t> fan, std::uint32_t vertex) {
  std::vector<std::uint32_t> part(fan.size(), no_index);
  std::uint32_t count = 0;
  std::vector<std::size_t> pending;  // assigned to a part; their neighbors may not be yet
  for (std::size_t first = 0; first < fan.size(); ++first) {
    if (part[first] != no_index) continue;
    part[first] = count++;
    pending.push_back(first);
    while (!pending.empty()) {
      const std::size_t i = pending.back();
      pending.pop_back();
      for (std::size_t j = 0; j < fan.size(); ++j) {
        const bool smooth = dot(normals[fan[i]], normals[fan[j]]) > cosine_of_crease;
        if (part[j] != no_index || !smooth || !adjoin(triangles[fan[i]], triangles[fan[j]], vertex)) continue;
        part[j] = part[i];
        pending.push_back(j);
      }
    }
  }
  return part;
}

}  // namespace

CreasedSurface::CreasedSurface(std::span<const Vec3d> rest, std::span<const Triangle> triangles)
    : vertices_(rest.size()), triangles_(triangles.begin(), triangles.end()) {
  const std::vector<Vec3d> normals = face_normals(rest, triangles);
  const Lists<std::uint32_t> around = vertex_triangles(triangles, rest.size());
  for (std::uint32_t v = 0; v < rest.size(); ++v) source_.push_back(v);
  for (std::uint32_t v = 0; v < rest.size(); ++v) {
    const std::span<const std::uint32_t> fan = around[v];
    const std::vector<std::uint32_t> part = smooth_parts(triangles, normals, fan, v);
    const auto first_copy = static_cast<std::uint32_t>(source_.size());
    for (std::size_t i = 0; i < fan.size(); ++i) {
      if (part[i] == 0) continue;  // the first part keeps the original vertex
      const std::uint32_t copy = first_copy + part[i] - 1;
      if (copy == source_.size()) source_.push_back(v);
      triangles_[fan[i]][corner_of(triangles[fan[i]], v)] = copy;
    }
  }
  positions_.resize(source_.size());
  normals_.resize(source_.size());
}

void CreasedSurface::update(std::span<const Vec3f> positions) {
  for (std::size_t v = 0; v < source_.size(); ++v) positions_[v] = positions[source_[v]];
  vertex_normals<float>(positions_, triangles_, normals_);
}

}  // namespace souple
