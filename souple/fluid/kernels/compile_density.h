#pragma once

#include "souple/fluid/kernels/density_kernels.h"
#include "souple/fluid/kernels/shapes.h"
#include "souple/math/simd/pack.h"

#include <cstring>

// Included by the translation units that are compiled for one instruction set, and by nothing else; every
// template here carries the set's tag.

#define SOUPLE_INLINE __attribute__((always_inline))

namespace souple::kernels {

typedef float FourLanes __attribute__((vector_size(16)));  // NOLINT(modernize-use-using)

/// Sixteen partial sums, in as many registers as they take.
template <class Set>
struct Sixteen {
  static constexpr int registers = 16 / Set::lanes;
  typename Set::Vector sum[registers];

  SOUPLE_INLINE Sixteen() {
    for (int r = 0; r < registers; ++r) sum[r] = Set::broadcast(0);
  }
  SOUPLE_INLINE void add(int r, simd::Pack<Set> terms) { sum[r] += terms.v; }
  /// (k, k + 4, k + 8, k + 12) added for k = 0 to 3, pairs that are eight apart first.
  SOUPLE_INLINE FourLanes four() const {
    FourLanes part[4];
    std::memcpy(part, sum, sizeof part);
    return (part[0] + part[2]) + (part[1] + part[3]);
  }
};

/// The four lanes of each added, (0 + 2) + (1 + 3).
SOUPLE_INLINE inline FourLanes add_lanes(FourLanes a, FourLanes b, FourLanes c, FourLanes d) {
  const FourLanes ab0 = {a[0] + a[2], a[1] + a[3], b[0] + b[2], b[1] + b[3]};
  const FourLanes cd0 = {c[0] + c[2], c[1] + c[3], d[0] + d[2], d[1] + d[3]};
  return FourLanes{ab0[0] + ab0[1], ab0[2] + ab0[3], cd0[0] + cd0[1], cd0[2] + cd0[3]};
}

/// The x, y, z and w of `lanes` records whose places times four stand at `list`.
template <class Set>
struct Gathered {
  typename Set::Vector x, y, z, w;

  SOUPLE_INLINE Gathered(const float* base, const std::uint32_t* list) {
    const auto r0 = Set::load_records(base, list), r1 = Set::load_records(base, list + 1),
               r2 = Set::load_records(base, list + 2), r3 = Set::load_records(base, list + 3);
    const auto low0 = Set::unpack_low(r0, r1), low1 = Set::unpack_low(r2, r3);
    const auto high0 = Set::unpack_high(r0, r1), high1 = Set::unpack_high(r2, r3);
    x = Set::pair_low(low0, low1), y = Set::pair_high(low0, low1);
    z = Set::pair_low(high0, high1), w = Set::pair_high(high0, high1);
  }
};

/// A particle against `lanes` of its neighbours.
template <class Set>
struct Near {
  using T = simd::Pack<Set>;
  T dx, dy, dz, r2, q;

  SOUPLE_INLINE Near(const Gathered<Set>& other, const Vec4f& at, const SmoothingFactors& factors) {
    dx = T(at.x) - T(other.x), dy = T(at.y) - T(other.y), dz = T(at.z) - T(other.z);
    r2 = dx * dx + dy * dy + dz * dz;
    // Not zero: some slopes are divided by it.
    q = sqrt(max(r2, T(1e-30f))) * T(factors.inverse_h);
  }
};

template <class Set, class Shape>
DensitySums density_sums(const Vec4f* records, const Vec4f& at, const std::uint32_t* list, std::size_t count,
                         const SmoothingFactors& factors) {
  using T = simd::Pack<Set>;
  Sixteen<Set> density, squared, gx, gy, gz;
  for (std::size_t k = 0; k < count; k += 16) {
    for (int r = 0; r < Sixteen<Set>::registers; ++r) {
      const Gathered<Set> other(&records->x, list + k + static_cast<std::size_t>(r * Set::lanes));
      const Near<Set> near(other, at, factors);
      const T slope = T(factors.slope_factor) * Shape::slope(near.q);
      density.add(r, Shape::value(near.q));
      squared.add(r, T(other.w) * (slope * slope * near.r2));
      gx.add(r, slope * near.dx);
      gy.add(r, slope * near.dy);
      gz.add(r, slope * near.dz);
    }
  }
  const FourLanes four = add_lanes(density.four(), gx.four(), gy.four(), gz.four());
  const FourLanes q = squared.four();
  return {factors.value_factor * four[0], (q[0] + q[2]) + (q[1] + q[3]), {four[1], four[2], four[3]}};
}

template <class Set, class Shape>
Vec3f density_push(const Vec4f* records, const Vec4f& at, const std::uint32_t* list, std::size_t count,
                   const SmoothingFactors& factors) {
  using T = simd::Pack<Set>;
  Sixteen<Set> px, py, pz;
  for (std::size_t k = 0; k < count; k += 16) {
    for (int r = 0; r < Sixteen<Set>::registers; ++r) {
      const Gathered<Set> other(&records->x, list + k + static_cast<std::size_t>(r * Set::lanes));
      const Near<Set> near(other, at, factors);
      const T pull = (T(at.w) + T(other.w)) * (T(factors.slope_factor) * Shape::slope(near.q));
      px.add(r, pull * near.dx);
      py.add(r, pull * near.dy);
      pz.add(r, pull * near.dz);
    }
  }
  const FourLanes four = add_lanes(px.four(), py.four(), pz.four(), FourLanes{});
  return {four[0], four[1], four[2]};
}

template <class Set, class Shape>
Vec3f density_spread(const Vec4f* records, const Vec4f* values, const Vec4f& at, const Vec4f& value,
                     const std::uint32_t* list, std::size_t count, const SmoothingFactors& factors) {
  using T = simd::Pack<Set>;
  Sixteen<Set> vx, vy, vz;
  for (std::size_t k = 0; k < count; k += 16) {
    for (int r = 0; r < Sixteen<Set>::registers; ++r) {
      const std::uint32_t* places = list + k + static_cast<std::size_t>(r * Set::lanes);
      const Near<Set> near(Gathered<Set>(&records->x, places), at, factors);
      const Gathered<Set> other(&values->x, places);
      const T weight = T(factors.value_factor) * Shape::value(near.q);
      vx.add(r, weight * (T(other.x) - T(value.x)));
      vy.add(r, weight * (T(other.y) - T(value.y)));
      vz.add(r, weight * (T(other.z) - T(value.z)));
    }
  }
  const FourLanes four = add_lanes(vx.four(), vy.four(), vz.four(), FourLanes{});
  return {four[0], four[1], four[2]};
}

template <class Set, class Shape>
const DensityKernels& density_kernels() {
  static constexpr DensityKernels kernels{density_sums<Set, Shape>, density_push<Set, Shape>,
                                          density_spread<Set, Shape>};
  return kernels;
}

}  // namespace souple::kernels
