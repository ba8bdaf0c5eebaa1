#pragma once

#include "souple/geometry/triangle_mesh.h"

#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <vector>

namespace souple::test {

/// A closed surface around the Y axis from a profile of (radius, height) that starts and ends on the axis,
/// upwards on the outside.
inline TriangleMesh revolved(const std::vector<std::array<double, 2>>& profile, int segments) {
  TriangleMesh mesh;
  const auto n = static_cast<std::uint32_t>(segments);
  const auto rings = static_cast<std::uint32_t>(profile.size() - 2);
  mesh.positions.push_back({0, profile.front()[1], 0});
  for (std::size_t r = 1; r + 1 < profile.size(); ++r) {
    for (int s = 0; s < segments; ++s) {
      const double angle = 2 * std::numbers::pi * s / segments;
      mesh.positions.push_back(
          {profile[r][0] * std::cos(angle), profile[r][1], -profile[r][0] * std::sin(angle)});
    }
  }
  mesh.positions.push_back({0, profile.back()[1], 0});
  const auto last = static_cast<std::uint32_t>(mesh.positions.size() - 1);
  const auto at = [&](std::uint32_t ring, std::uint32_t s) { return 1 + ring * n + s % n; };
  for (std::uint32_t s = 0; s < n; ++s) {
    mesh.triangles.push_back({0, at(0, s + 1), at(0, s)});
    for (std::uint32_t r = 0; r + 1 < rings; ++r) {
      mesh.triangles.push_back({at(r, s), at(r, s + 1), at(r + 1, s + 1)});
      mesh.triangles.push_back({at(r, s), at(r + 1, s + 1), at(r + 1, s)});
    }
    mesh.triangles.push_back({last, at(rings - 1, s), at(rings - 1, s + 1)});
  }
  return mesh;
}

/// A drinking glass on the origin, whose cavity is a cylinder of the given radius and height.
inline TriangleMesh glass(double radius, double height, double wall, int segments) {
  const double outer = radius + wall;
  return revolved({{0, -wall}, {outer, -wall}, {outer, height}, {radius, height}, {radius, 0}, {0, 0}},
                  segments);
}

}  // namespace souple::test
