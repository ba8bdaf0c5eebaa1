#pragma once

#include "souple/fluid/kernels/density_kernels.h"
#include "souple/fluid/kernels/shapes.h"
#include "souple/simd/registers.h"

#include <cstring>

// Included only by translation units compiled for one instruction set; every template carries the set's tag.

namespace souple::kernels {

typedef float FourLanes __attribute__((vector_size(16)));   // NOLINT(modernize-use-using)
typedef float EightLanes __attribute__((vector_size(32)));  // NOLINT(modernize-use-using)

/// Selects lanes: 0 to 3 are those of a, 4 to 7 those of b.
template <int I, int J, int K, int L>
SOUPLE_INLINE inline FourLanes shuffled(FourLanes a, FourLanes b) {
#if defined(__clang__)
  return __builtin_shufflevector(a, b, I, J, K, L);
#else
  typedef int Choice __attribute__((vector_size(16)));  // NOLINT(modernize-use-using)
  return __builtin_shuffle(a, b, Choice{I, J, K, L});
#endif
}

/// Sixteen partial sums, in as many registers as needed.
template <class Isa>
struct Sixteen {
  static constexpr int registers = 16 / Isa::lanes;
  typename Isa::Vector sum[registers];

  SOUPLE_INLINE Sixteen() {
    for (int r = 0; r < registers; ++r) sum[r] = Isa::broadcast(0);
  }
  SOUPLE_INLINE void add(int r, simd::Pack<Isa> terms) { sum[r] += terms.v; }
  /// Sums (k, k + 4, k + 8, k + 12) for k = 0 to 3, first the pairs eight apart.
  SOUPLE_INLINE FourLanes four() const {
    if constexpr (Isa::lanes == 1) {
      FourLanes four;
      for (int k = 0; k < 4; ++k) four[k] = (sum[k] + sum[k + 8]) + (sum[k + 4] + sum[k + 12]);
      return four;
    } else if constexpr (Isa::lanes == 4) {
      return (sum[0] + sum[2]) + (sum[1] + sum[3]);
    } else {
      EightLanes half[2];
      std::memcpy(half, sum, sizeof half);
      const EightLanes both = half[0] + half[1];
      FourLanes part[2];
      std::memcpy(part, &both, sizeof part);
      return part[0] + part[1];
    }
  }
};

/// The sum of each argument's four lanes, (0 + 2) + (1 + 3).
SOUPLE_INLINE inline FourLanes add_lanes(FourLanes a, FourLanes b, FourLanes c, FourLanes d) {
  const FourLanes ab = shuffled<0, 4, 1, 5>(a, b) + shuffled<2, 6, 3, 7>(a, b);
  const FourLanes cd = shuffled<0, 4, 1, 5>(c, d) + shuffled<2, 6, 3, 7>(c, d);
  return shuffled<0, 1, 4, 5>(ab, cd) + shuffled<2, 3, 6, 7>(ab, cd);
}

/// The x, y, z and w of `lanes` records, whose offsets are `list` [floats].
template <class Isa>
struct Gathered {
  typename Isa::Vector x, y, z, w;

  SOUPLE_INLINE Gathered(const float* base, const std::uint32_t* list) {
    Records<Isa> records(base, list);
    records.transpose();
    x = records.r[0], y = records.r[1], z = records.r[2], w = records.r[3];
  }
};

/// A particle and `lanes` of its neighbors.
template <class Isa>
struct Near {
  using T = simd::Pack<Isa>;
  T dx, dy, dz, r2, q;

  SOUPLE_INLINE Near(const Gathered<Isa>& other, const Vec4f& at, const SmoothingFactors& factors) {
    dx = T(at.x) - T(other.x), dy = T(at.y) - T(other.y), dz = T(at.z) - T(other.z);
    r2 = dx * dx + dy * dy + dz * dz;
    // Nonzero: some slopes divide by q.
    q = sqrt(max(r2, T(1e-30f))) * T(factors.inverse_h);
  }
};

template <class Isa, class Shape>
SOUPLE_INLINE inline DensitySums density_sums_here(const Vec4f* records, const Vec4f& at,
                                                   const std::uint32_t* list, std::size_t count,
                                                   const SmoothingFactors& factors) {
  using T = simd::Pack<Isa>;
  Sixteen<Isa> density, squared, gx, gy, gz;
  // Slopes are about 1 / d^5: their squares leave the range of floats below 0.2 mm. A power of two changes no
  // digit.
  const float scaled_slope = factors.slope_factor * factors.scale, unscale = 1 / factors.scale;
  for (std::size_t k = 0; k < count; k += 16) {
    for (int r = 0; r < Sixteen<Isa>::registers; ++r) {
      const Gathered<Isa> other(&records->x, list + k + static_cast<std::size_t>(r * Isa::lanes));
      const Near<Isa> near(other, at, factors);
      const T slope = T(scaled_slope) * Shape::slope(near.q);
      density.add(r, Shape::value(near.q));
      squared.add(r, T(other.w) * (slope * slope * near.r2));
      gx.add(r, slope * near.dx);
      gy.add(r, slope * near.dy);
      gz.add(r, slope * near.dz);
    }
  }
  const FourLanes four = add_lanes(density.four(), gx.four(), gy.four(), gz.four());
  const FourLanes q = squared.four();
  return {factors.value_factor * four[0],
          (q[0] + q[2]) + (q[1] + q[3]),
          {four[1] * unscale, four[2] * unscale, four[3] * unscale}};
}

/// A pair's extra term besides q_i + q_j.
struct NoRepulsion {
  template <class Shape, class T>
  SOUPLE_INLINE T operator()(T q_sum, T) const {
    return q_sum;
  }
};
template <class Isa>
struct SomeRepulsion {
  Repulsion repulsion;
  template <class Shape, class T>
  SOUPLE_INLINE T operator()(T q_sum, T q) const {
    const T part = T(repulsion.scale) * Shape::value(q), squared = part * part;
    return q_sum + T(repulsion.strength) * (squared * squared);
  }
};

template <class Isa, class Shape, class Repel = NoRepulsion>
SOUPLE_INLINE inline Vec3f density_push_here(const Vec4f* records, const Vec4f& at, const std::uint32_t* list,
                                             std::size_t count, const SmoothingFactors& factors,
                                             const Repel& repel = {}) {
  using T = simd::Pack<Isa>;
  Sixteen<Isa> px, py, pz;
  for (std::size_t k = 0; k < count; k += 16) {
    for (int r = 0; r < Sixteen<Isa>::registers; ++r) {
      const Gathered<Isa> other(&records->x, list + k + static_cast<std::size_t>(r * Isa::lanes));
      const Near<Isa> near(other, at, factors);
      const T q_sum = repel.template operator()<Shape, T>(T(at.w) + T(other.w), near.q);
      const T pull = q_sum * (T(factors.slope_factor) * Shape::slope(near.q));
      px.add(r, pull * near.dx);
      py.add(r, pull * near.dy);
      pz.add(r, pull * near.dz);
    }
  }
  const FourLanes four = add_lanes(px.four(), py.four(), pz.four(), FourLanes{});
  return {four[0], four[1], four[2]};
}

template <class Isa, class Shape>
DensitySums density_sums(const Vec4f* records, const Vec4f& at, const std::uint32_t* list, std::size_t count,
                         const SmoothingFactors& factors) {
  return density_sums_here<Isa, Shape>(records, at, list, count, factors);
}

template <class Isa, class Shape>
Vec3f density_push(const Vec4f* records, const Vec4f& at, const std::uint32_t* list, std::size_t count,
                   const SmoothingFactors& factors) {
  return density_push_here<Isa, Shape>(records, at, list, count, factors);
}

template <class Isa, class Shape>
void density_sums_of(const Vec4f* records, const NeighborLists& lists, const SmoothingFactors& given,
                     DensitySums* result) {
  const SmoothingFactors factors = given;
  const std::uint32_t *entry = lists.entry, *first = lists.first;
  for (std::uint32_t place = lists.begin; place < lists.end; ++place, ++first, ++result)
    *result = density_sums_here<Isa, Shape>(records, records[place], entry + first[0], first[1] - first[0],
                                            factors);
}

template <class Isa, class Shape>
void density_push_of(const Vec4f* records, const NeighborLists& lists, const SmoothingFactors& given,
                     Vec3f* result) {
  const SmoothingFactors factors = given;
  const std::uint32_t *entry = lists.entry, *first = lists.first;
  for (std::uint32_t place = lists.begin; place < lists.end; ++place, ++first, ++result)
    *result = density_push_here<Isa, Shape>(records, records[place], entry + first[0], first[1] - first[0],
                                            factors);
}

template <class Isa, class Shape>
void density_repel_of(const Vec4f* records, const NeighborLists& lists, const SmoothingFactors& given,
                      const Repulsion& repulsion, Vec3f* result) {
  const SmoothingFactors factors = given;
  const SomeRepulsion<Isa> repel{repulsion};
  const std::uint32_t *entry = lists.entry, *first = lists.first;
  for (std::uint32_t place = lists.begin; place < lists.end; ++place, ++first, ++result)
    *result = density_push_here<Isa, Shape>(records, records[place], entry + first[0], first[1] - first[0],
                                            factors, repel);
}

template <class Isa, class Shape>
Vec3f density_spread(const Vec4f* records, const Vec4f* values, const Vec4f& at, const Vec4f& value,
                     const std::uint32_t* list, std::size_t count, const SmoothingFactors& factors) {
  using T = simd::Pack<Isa>;
  Sixteen<Isa> vx, vy, vz;
  for (std::size_t k = 0; k < count; k += 16) {
    for (int r = 0; r < Sixteen<Isa>::registers; ++r) {
      const std::uint32_t* entries = list + k + static_cast<std::size_t>(r * Isa::lanes);
      const Near<Isa> near(Gathered<Isa>(&records->x, entries), at, factors);
      const Gathered<Isa> other(&values->x, entries);
      const T weight = T(factors.value_factor) * Shape::value(near.q);
      vx.add(r, weight * (T(other.x) - T(value.x)));
      vy.add(r, weight * (T(other.y) - T(value.y)));
      vz.add(r, weight * (T(other.z) - T(value.z)));
    }
  }
  const FourLanes four = add_lanes(vx.four(), vy.four(), vz.four(), FourLanes{});
  return {four[0], four[1], four[2]};
}

template <class Isa, class Shape>
const DensityKernels& density_kernels() {
  static constexpr DensityKernels kernels{density_sums_of<Isa, Shape>,  density_push_of<Isa, Shape>,
                                          density_repel_of<Isa, Shape>, density_sums<Isa, Shape>,
                                          density_push<Isa, Shape>,     density_spread<Isa, Shape>};
  return kernels;
}

}  // namespace souple::kernels
