#pragma once

#include "souple/fluid/kernels/density_kernels.h"

#include <cmath>

// Scalar reference of compile_density.h: one neighbor at a time.

namespace souple::kernels {

struct PlainNear {
  Vec3f d;
  float r2, q;

  PlainNear(const Vec4f& at, const Vec4f& other, const SmoothingFactors& factors) {
    d = at.xyz() - other.xyz();
    r2 = d.x * d.x + d.y * d.y + d.z * d.z;
    q = std::sqrt(max(r2, 1e-30f)) * factors.inverse_h;
  }
};

struct PlainSixteen {
  float sum[16] = {};
  float total() const {
    float four[4];
    for (int k = 0; k < 4; ++k) four[k] = (sum[k] + sum[k + 8]) + (sum[k + 4] + sum[k + 12]);
    return (four[0] + four[2]) + (four[1] + four[3]);
  }
};

struct PlainSixteenOfThree {
  PlainSixteen x, y, z;
  void add(std::size_t k, const Vec3f& term) {
    x.sum[k % 16] += term.x;
    y.sum[k % 16] += term.y;
    z.sum[k % 16] += term.z;
  }
  Vec3f total() const { return {x.total(), y.total(), z.total()}; }
};

}  // namespace souple::kernels
