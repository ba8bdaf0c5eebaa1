#include "render/vertex_colors.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace souple::render {

HeatScale::HeatScale() : not_a_number_(pack(heat(std::numeric_limits<float>::quiet_NaN()))) {
  for (std::size_t i = 0; i < colors_.size(); ++i)
    colors_[i] = pack(heat(static_cast<float>(i) / static_cast<float>(colors_.size() - 1)));
}

PackedColor HeatScale::operator()(float t) const {
  if (std::isnan(t)) return not_a_number_;
  const float steps = static_cast<float>(colors_.size() - 1);
  return colors_[static_cast<std::size_t>(std::lround(std::clamp(t, 0.0f, 1.0f) * steps))];
}

void HeatScale::color(std::span<const float> values, float largest, std::vector<PackedColor>& out) const {
  const float scale = largest > 0 ? 1 / largest : 0;
  out.resize(values.size());
  for (std::size_t i = 0; i < values.size(); ++i) out[i] = (*this)(values[i] * scale);
}

EdgeStrain::EdgeStrain(std::span<const Vec3d> rest, std::span<const Triangle> triangles) {
  for (const Edge& edge : unique_edges(triangles)) {
    const double l = length(rest[edge[0]] - rest[edge[1]]);
    if (!(l > 0)) continue;
    edges_.push_back(edge);
    inverse_rest_.push_back(static_cast<float>(1 / l));
  }
}

void EdgeStrain::evaluate(std::span<const Vec3f> positions, std::vector<float>& out) const {
  out.assign(positions.size(), 0);
  for (std::size_t e = 0; e < edges_.size(); ++e) {
    const auto [a, b] = edges_[e];
    const float strain = length(positions[a] - positions[b]) * inverse_rest_[e] - 1;
    out[a] = std::max(out[a], strain);
    out[b] = std::max(out[b], strain);
  }
}

void color_normals(std::span<const Vec3f> normals, std::vector<PackedColor>& out) {
  out.resize(normals.size());
  const auto byte = [](float x) {
    return static_cast<PackedColor>(std::clamp(127.5f + 127.5f * x, 0.0f, 255.0f));
  };
  for (std::size_t i = 0; i < normals.size(); ++i) {
    const Vec3f& n = normals[i];
    out[i] = byte(n.x) | byte(n.y) << 8 | byte(n.z) << 16 | 0xff000000u;
  }
}

}  // namespace souple::render
