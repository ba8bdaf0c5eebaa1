#include "souple/fluid/kernels/density_kernels.h"

#include <algorithm>
#include <cmath>

// What compile_density.h does, one neighbour after the other.

namespace souple::kernels {

namespace {

struct Near {
  Vec3f d;
  float r2, slope;

  Near(const Vec4f& at, const Vec4f& other, const SmoothingFactors& factors) {
    d = at.xyz() - other.xyz();
    r2 = d.x * d.x + d.y * d.y + d.z * d.z;
    const float r = std::sqrt(std::max(r2, 1e-30f));
    const float s = std::max(factors.h - r, 0.0f);
    slope = factors.spiky * (s * s) / r;
  }
};

struct Sixteen {
  float sum[16] = {};
  float total() const {
    float four[4];
    for (int k = 0; k < 4; ++k) four[k] = (sum[k] + sum[k + 8]) + (sum[k + 4] + sum[k + 12]);
    return (four[0] + four[2]) + (four[1] + four[3]);
  }
};

DensitySums sums(const Vec4f* records, const Vec4f& at, const std::uint32_t* list, std::size_t count,
                 const SmoothingFactors& factors) {
  Sixteen density, squared, gx, gy, gz;
  for (std::size_t k = 0; k < count; ++k) {
    const Vec4f& other = records[list[k] / 4];
    const Near near(at, other, factors);
    const float t = std::max(factors.h * factors.h - near.r2, 0.0f);
    density.sum[k % 16] += t * t * t;
    squared.sum[k % 16] += other.w * (near.slope * near.slope * near.r2);
    gx.sum[k % 16] += near.slope * near.d.x;
    gy.sum[k % 16] += near.slope * near.d.y;
    gz.sum[k % 16] += near.slope * near.d.z;
  }
  return {factors.poly6 * density.total(), squared.total(), {gx.total(), gy.total(), gz.total()}};
}

float rate(const Vec4f* records, const Vec4f* motion, const Vec4f& at, const Vec4f& u,
           const std::uint32_t* list, std::size_t count, const SmoothingFactors& factors) {
  Sixteen sum;
  for (std::size_t k = 0; k < count; ++k) {
    const Near near(at, records[list[k] / 4], factors);
    const Vec3f relative = u.xyz() - motion[list[k] / 4].xyz();
    sum.sum[k % 16] += near.slope * (relative.x * near.d.x + relative.y * near.d.y + relative.z * near.d.z);
  }
  return sum.total();
}

Vec3f push(const Vec4f* records, const Vec4f& at, const std::uint32_t* list, std::size_t count,
           const SmoothingFactors& factors) {
  Sixteen px, py, pz;
  for (std::size_t k = 0; k < count; ++k) {
    const Vec4f& other = records[list[k] / 4];
    const Near near(at, other, factors);
    const float pull = (at.w + other.w) * near.slope;
    px.sum[k % 16] += pull * near.d.x;
    py.sum[k % 16] += pull * near.d.y;
    pz.sum[k % 16] += pull * near.d.z;
  }
  return {px.total(), py.total(), pz.total()};
}

}  // namespace

template <>
const DensityKernels& density_kernels<PlainLanes>() {
  static constexpr DensityKernels kernels{sums, rate, push};
  return kernels;
}

}  // namespace souple::kernels
