#pragma once

#include "souple/geometry/adjacency.h"
#include "souple/geometry/tet_mesh.h"
#include "souple/geometry/triangle_mesh.h"
#include "tests/collision/random.h"

#include <algorithm>
#include <cstdint>
#include <map>
#include <set>
#include <utility>

namespace souple::check {

using test::Random;

// Independent of the library, so that its mistakes are not repeated here.

/// Volume enclosed by a closed surface: the sum of signed tets to the origin.
inline double volume(const TriangleMesh& mesh) {
  double sum = 0;
  for (const Triangle& t : mesh.triangles)
    sum += dot(mesh.positions[t[0]], cross(mesh.positions[t[1]], mesh.positions[t[2]])) / 6;
  return sum;
}

inline double area(const TriangleMesh& mesh) {
  double sum = 0;
  for (const Triangle& t : mesh.triangles)
    sum += length(cross(mesh.positions[t[1]] - mesh.positions[t[0]],
                        mesh.positions[t[2]] - mesh.positions[t[0]])) /
           2;
  return sum;
}

inline double tet_volume(const TetMesh& mesh, const Tet& t) {
  const Vec3d &a = mesh.positions[t[0]], &b = mesh.positions[t[1]], &c = mesh.positions[t[2]],
              &d = mesh.positions[t[3]];
  return dot(cross(b - a, c - a), d - a) / 6;
}

/// Every directed edge occurs once, and so does its reverse: closed, manifold along edges, consistently
/// wound.
inline bool is_watertight(const std::vector<Triangle>& triangles) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> directed;
  for (const Triangle& t : triangles)
    for (std::size_t i = 0; i < 3; ++i) ++directed[{t[i], t[(i + 1) % 3]}];
  for (const auto& [edge, count] : directed) {
    const auto reverse = directed.find({edge.second, edge.first});
    if (count != 1 || reverse == directed.end() || edge.first == edge.second) return false;
  }
  return !triangles.empty();
}

/// V - E + F over used vertices: 2 for a sphere, 0 for a torus, 1 for a disk.
inline long euler_characteristic(const std::vector<Triangle>& triangles) {
  std::set<std::uint32_t> vertices;
  std::set<std::pair<std::uint32_t, std::uint32_t>> edges;
  for (const Triangle& t : triangles)
    for (std::size_t i = 0; i < 3; ++i) {
      vertices.insert(t[i]);
      edges.insert(std::minmax(t[i], t[(i + 1) % 3]));
    }
  return long(vertices.size()) - long(edges.size()) + long(triangles.size());
}

}  // namespace souple::check
