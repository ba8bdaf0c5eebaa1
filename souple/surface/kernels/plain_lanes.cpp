#include "souple/surface/kernels/surface_kernels.h"

#include <cmath>

// The functions of compile_surface.h, one lane after another.

namespace souple::kernels {

namespace {

struct Sixteen {
  float sum[16] = {};
  float total() const {
    float four[4];
    for (int k = 0; k < 4; ++k) four[k] = (sum[k] + sum[k + 8]) + (sum[k + 4] + sum[k + 12]);
    return (four[0] + four[2]) + (four[1] + four[3]);
  }
};

Moments moments(const Vec4f* records, const Vec4f& at, const std::uint32_t* list, std::size_t count,
                float inverse_radius) {
  Sixteen weight, x, y, z, xx, xy, xz, yy, yz, zz;
  for (std::size_t k = 0; k < count; ++k) {
    const Vec4f& other = records[list[k] / 4];
    const float dx = other.x - at.x, dy = other.y - at.y, dz = other.z - at.z;
    const float q = std::sqrt(dx * dx + dy * dy + dz * dz) * inverse_radius;
    const float w = max(1.0f - q * q * q, 0.0f);
    const float wx = w * dx, wy = w * dy, wz = w * dz;
    const std::size_t s = k % 16;
    weight.sum[s] += w;
    x.sum[s] += wx, y.sum[s] += wy, z.sum[s] += wz;
    xx.sum[s] += wx * dx, xy.sum[s] += wx * dy, xz.sum[s] += wx * dz;
    yy.sum[s] += wy * dy, yz.sum[s] += wy * dz, zz.sum[s] += wz * dz;
  }
  return {weight.total() + 1, {x.total(), y.total(), z.total()},
          xx.total(),         xy.total(),
          xz.total(),         yy.total(),
          yz.total(),         zz.total()};
}

void add_to_brick(const ParticleKernel& p, const float* origin, float cell, float* values) {
  const float sx = origin[0] - p.center[0], sy = origin[1] - p.center[1], sz = origin[2] - p.center[2];
  const float u0 = p.xx * sx + p.xy * sy + p.xz * sz;
  const float v0 = p.xy * sx + p.yy * sy + p.yz * sz;
  const float w0 = p.xz * sx + p.yz * sy + p.zz * sz;
  for (int n = 0; n < brick_nodes; ++n) {
    const int row = n / 4, layer = n / 16;
    const auto i = static_cast<float>(n % 4), j = static_cast<float>(row % 4), k = static_cast<float>(layer);
    const float u = u0 + i * (cell * p.xx) + j * (cell * p.xy) + k * (cell * p.xz);
    const float v = v0 + i * (cell * p.xy) + j * (cell * p.yy) + k * (cell * p.yz);
    const float w = w0 + i * (cell * p.xz) + j * (cell * p.yz) + k * (cell * p.zz);
    const float t = max(1.0f - (u * u + v * v + w * w), 0.0f);
    values[n] += p.weight * (t * t * t);
  }
}

void brick(const ParticleKernel* kernels, const std::uint32_t* list, std::size_t count, const float* origin,
           float cell, float* values) {
  for (int n = 0; n < brick_nodes; ++n) values[n] = 0;
  for (std::size_t n = 0; n < count; ++n) add_to_brick(kernels[list[n]], origin, cell, values);
}

void points(const ParticleKernel* kernels, const std::uint32_t* list, std::size_t count,
            const FieldPoints& points, std::size_t point_count) {
  for (std::size_t k = 0; k < point_count; ++k) {
    float value = 0, gradient[3] = {}, shift[3] = {}, crowd = 0;
    for (std::size_t n = 0; n < count; ++n) {
      const ParticleKernel& p = kernels[list[n]];
      const float sx = points.at[0][k] - p.center[0], sy = points.at[1][k] - p.center[1],
                  sz = points.at[2][k] - p.center[2];
      const float u = p.xx * sx + p.xy * sy + p.xz * sz;
      const float v = p.xy * sx + p.yy * sy + p.yz * sz;
      const float w = p.xz * sx + p.yz * sy + p.zz * sz;
      const float t = max(1.0f - (u * u + v * v + w * w), 0.0f);
      const float slope = p.weight * (t * t), added = slope * t;
      value += added;
      gradient[0] += slope * (p.xx * u + p.xy * v + p.xz * w);
      gradient[1] += slope * (p.xy * u + p.yy * v + p.yz * w);
      gradient[2] += slope * (p.xz * u + p.yz * v + p.zz * w);
      for (int a = 0; a < 3; ++a) shift[a] += added * p.shift[a];
      crowd += added * p.crowd;
    }
    points.value[k] = value;
    points.crowd[k] = crowd / max(value, 1e-30f);
    for (int a = 0; a < 3; ++a) {
      points.gradient[a][k] = gradient[a] * -6.0f;
      points.shift[a][k] = shift[a] / max(value, 1e-30f);
    }
  }
}

}  // namespace

template <>
const SurfaceKernels& surface_kernels<PlainLanes>() {
  static constexpr SurfaceKernels plain{moments, brick, points};
  return plain;
}

}  // namespace souple::kernels
