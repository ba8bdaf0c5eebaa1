#pragma once

#include "souple/fluid/kernels/compile_density.h"
#include "souple/surface/kernels/surface_kernels.h"

// Included only by translation units compiled for one instruction set. Every template has the set's tag as a
// parameter.

namespace souple::kernels {

template <class Isa>
Moments surface_moments(const Vec4f* records, const Vec4f& at, const std::uint32_t* list, std::size_t count,
                        float inverse_radius) {
  using T = simd::Pack<Isa>;
  Sixteen<Isa> weight, x, y, z, xx, xy, xz, yy, yz, zz;
  for (std::size_t k = 0; k < count; k += 16) {
    for (int r = 0; r < Sixteen<Isa>::registers; ++r) {
      const Gathered<Isa> other(&records->x, list + k + static_cast<std::size_t>(r * Isa::lanes));
      const T dx = T(other.x) - T(at.x), dy = T(other.y) - T(at.y), dz = T(other.z) - T(at.z);
      const T q = sqrt(dx * dx + dy * dy + dz * dz) * T(inverse_radius);
      const T w = max(T(1.0f) - q * q * q, T(0.0f));
      const T wx = w * dx, wy = w * dy, wz = w * dz;
      weight.add(r, w);
      x.add(r, wx), y.add(r, wy), z.add(r, wz);
      xx.add(r, wx * dx), xy.add(r, wx * dy), xz.add(r, wx * dz);
      yy.add(r, wy * dy), yz.add(r, wy * dz), zz.add(r, wz * dz);
    }
  }
  const FourLanes a = add_lanes(weight.four(), x.four(), y.four(), z.four());
  const FourLanes b = add_lanes(xx.four(), xy.four(), xz.four(), yy.four());
  const FourLanes c = add_lanes(yz.four(), zz.four(), FourLanes{}, FourLanes{});
  // The particle itself: w = 1, d = 0.
  return {a[0] + 1, {a[1], a[2], a[3]}, b[0], b[1], b[2], b[3], c[0], c[1]};
}

/// G (x - center) at nodes i + 4 j of a brick's lowest layer, and its increment from layer to layer.
template <class Isa>
struct BrickMap {
  using T = simd::Pack<Isa>;
  static constexpr int registers = 16 / Isa::lanes;
  T u[registers], v[registers], w[registers];
  float up[3];

  SOUPLE_INLINE BrickMap(const ParticleKernel& p, const float* origin, float cell) {
    static constexpr float along_x[16] = {0, 1, 2, 3, 0, 1, 2, 3, 0, 1, 2, 3, 0, 1, 2, 3};
    static constexpr float along_y[16] = {0, 0, 0, 0, 1, 1, 1, 1, 2, 2, 2, 2, 3, 3, 3, 3};
    const float sx = origin[0] - p.center[0], sy = origin[1] - p.center[1], sz = origin[2] - p.center[2];
    const float u0 = p.xx * sx + p.xy * sy + p.xz * sz;
    const float v0 = p.xy * sx + p.yy * sy + p.yz * sz;
    const float w0 = p.xz * sx + p.yz * sy + p.zz * sz;
    for (int r = 0; r < registers; ++r) {
      const T i = T::load(along_x + r * Isa::lanes), j = T::load(along_y + r * Isa::lanes);
      u[r] = T(u0) + i * T(cell * p.xx) + j * T(cell * p.xy);
      v[r] = T(v0) + i * T(cell * p.xy) + j * T(cell * p.yy);
      w[r] = T(w0) + i * T(cell * p.xz) + j * T(cell * p.yz);
    }
    up[0] = cell * p.xz, up[1] = cell * p.yz, up[2] = cell * p.zz;
  }
};

template <class Isa>
void surface_brick(const ParticleKernel* kernels, const std::uint32_t* list, std::size_t count,
                   const float* origin, float cell, float* values) {
  using T = simd::Pack<Isa>;
  constexpr int registers = BrickMap<Isa>::registers;
  T sum[brick_side][registers];
  for (auto& layer : sum)
    for (T& register_of : layer) register_of = T(0.0f);
  for (std::size_t n = 0; n < count; ++n) {
    const ParticleKernel& p = kernels[list[n]];
    const BrickMap<Isa> map(p, origin, cell);
    for (int k = 0; k < brick_side; ++k) {
      // A layer outside the kernel's support would get 0.
      const float height = origin[2] + static_cast<float>(k) * cell - p.center[2];
      if (height > p.extent_z || height < -p.extent_z) continue;
      const auto up = static_cast<float>(k);
      const T du(up * map.up[0]), dv(up * map.up[1]), dw(up * map.up[2]);
      for (int r = 0; r < registers; ++r) {
        const T u = map.u[r] + du, v = map.v[r] + dv, w = map.w[r] + dw;
        const T t = max(T(1.0f) - (u * u + v * v + w * w), T(0.0f));
        sum[k][r] += T(p.weight) * (t * t * t);
      }
    }
  }
  for (int k = 0; k < brick_side; ++k) {
    for (int r = 0; r < registers; ++r) {
      const std::size_t first = 16 * static_cast<std::size_t>(k) + static_cast<std::size_t>(r * Isa::lanes);
      sum[k][r].store(values + first);
    }
  }
}

template <class Isa>
void surface_points(const ParticleKernel* kernels, const std::uint32_t* list, std::size_t count,
                    const FieldPoints& points, std::size_t point_count) {
  using T = simd::Pack<Isa>;
  for (std::size_t first = 0; first < point_count; first += Isa::lanes) {
    const T x = T::load(points.at[0] + first), y = T::load(points.at[1] + first),
            z = T::load(points.at[2] + first);
    T value(0.0f), gx(0.0f), gy(0.0f), gz(0.0f), shift_x(0.0f), shift_y(0.0f), shift_z(0.0f), crowd(0.0f);
    for (std::size_t n = 0; n < count; ++n) {
      const ParticleKernel& p = kernels[list[n]];
      const T sx = x - T(p.center[0]), sy = y - T(p.center[1]), sz = z - T(p.center[2]);
      const T u = T(p.xx) * sx + T(p.xy) * sy + T(p.xz) * sz;
      const T v = T(p.xy) * sx + T(p.yy) * sy + T(p.yz) * sz;
      const T w = T(p.xz) * sx + T(p.yz) * sy + T(p.zz) * sz;
      const T t = max(T(1.0f) - (u * u + v * v + w * w), T(0.0f));
      const T slope = T(p.weight) * (t * t), added = slope * t;
      value += added;
      gx += slope * (T(p.xx) * u + T(p.xy) * v + T(p.xz) * w);
      gy += slope * (T(p.xy) * u + T(p.yy) * v + T(p.yz) * w);
      gz += slope * (T(p.xz) * u + T(p.yz) * v + T(p.zz) * w);
      shift_x += added * T(p.shift[0]);
      shift_y += added * T(p.shift[1]);
      shift_z += added * T(p.shift[2]);
      crowd += added * T(p.crowd);
    }
    // Without any kernel the shift is 0 / 1e-30 = 0.
    const T all = max(value, T(1e-30f));
    value.store(points.value + first);
    (gx * T(-6.0f)).store(points.gradient[0] + first);
    (gy * T(-6.0f)).store(points.gradient[1] + first);
    (gz * T(-6.0f)).store(points.gradient[2] + first);
    (shift_x / all).store(points.shift[0] + first);
    (shift_y / all).store(points.shift[1] + first);
    (shift_z / all).store(points.shift[2] + first);
    (crowd / all).store(points.crowd + first);
  }
}

template <class Isa>
const SurfaceKernels& surface_kernels() {
  static constexpr SurfaceKernels kernels{surface_moments<Isa>, surface_brick<Isa>, surface_points<Isa>};
  return kernels;
}

}  // namespace souple::kernels
