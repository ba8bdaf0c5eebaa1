#pragma once

#include "souple/geometry/triangle_mesh.h"
#include "souple/host/vertex_welder.h"

namespace souple::host {

/// A mesh as importers deliver it: a vertex for each corner of each triangle.
struct Corners {
  std::vector<float> positions, normals;
  std::vector<std::uint32_t> indices;

  explicit Corners(const TriangleMesh& mesh) {
    for (const Triangle& triangle : mesh.triangles)
      for (const std::uint32_t v : triangle) {
        indices.push_back(static_cast<std::uint32_t>(indices.size()));
        for (int k = 0; k < 3; ++k) positions.push_back(static_cast<float>(mesh.positions[v][k]));
      }
    normals.resize(positions.size());
  }
  std::size_t count() const { return positions.size() / 3; }
  TriangleSoup soup() const { return {positions.data(), count(), indices.data(), indices.size() / 3}; }
  Vec3f at(std::size_t v) const { return {positions[3 * v], positions[3 * v + 1], positions[3 * v + 2]}; }
  Vec3f normal(std::size_t v) const { return {normals[3 * v], normals[3 * v + 1], normals[3 * v + 2]}; }
};

}  // namespace souple::host
