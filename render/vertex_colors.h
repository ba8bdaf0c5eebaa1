#pragma once

#include "render/color.h"
#include "souple/geometry/adjacency.h"
#include "souple/math/vec3.h"

#include <array>
#include <span>
#include <vector>

namespace souple::render {

/// Tabulated `heat`, for many values.
class HeatScale {
 public:
  HeatScale();
  PackedColor operator()(float t) const;  ///< t in [0, 1], clamped; NaN has a color of its own
  /// out[i] = color of values[i] / largest.
  void color(std::span<const float> values, float largest, std::vector<PackedColor>& out) const;

 private:
  std::array<PackedColor, 256> colors_{};
  PackedColor not_a_number_ = 0;
};

/// Strain of a surface or a line at its vertices.
class EdgeStrain {
 public:
  EdgeStrain() = default;
  /// Edges of triangles over these rest positions [m]; edges of zero length are omitted.
  EdgeStrain(std::span<const Vec3d> rest, std::span<const Triangle> triangles);

  /// out[v] = maximum of (l - l0) / l0 over the edges at v; 0 where all are compressed or there is none.
  void evaluate(std::span<const Vec3f> positions, std::vector<float>& out) const;

 private:
  std::vector<Edge> edges_;
  std::vector<float> inverse_rest_;  ///< 1 / l0 [1/m]
};

/// Directions as colors: x, y, z in [-1, 1] as red, green, blue.
void color_normals(std::span<const Vec3f> normals, std::vector<PackedColor>& out);

}  // namespace souple::render
