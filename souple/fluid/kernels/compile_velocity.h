#pragma once

#include "souple/fluid/kernels/compile_density.h"
#include "souple/fluid/kernels/velocity_kernels.h"

// Included only by translation units compiled for one instruction set; every template carries the set's tag.

namespace souple::kernels {

/// Three sums, each of sixteen partial sums.
template <class Isa>
struct SixteenOfThree {
  using T = simd::Pack<Isa>;
  Sixteen<Isa> x, y, z;

  SOUPLE_INLINE void add(int r, T ax, T ay, T az) { x.add(r, ax), y.add(r, ay), z.add(r, az); }
  SOUPLE_INLINE Vec3f total() const {
    const FourLanes four = add_lanes(x.four(), y.four(), z.four(), FourLanes{});
    return {four[0], four[1], four[2]};
  }
};

/// Data of a particle and `lanes` of its neighbors.
template <class Isa>
struct Pair {
  using T = simd::Pack<Isa>;
  Near<Isa> near;
  Gathered<Isa> other;
  T x, y, z;  // value_i - value_j

  SOUPLE_INLINE Pair(const Vec4f* records, const Vec4f* values, const Vec4f& at, const Vec4f& value,
                     const std::uint32_t* list, const SmoothingFactors& factors)
      : near(Gathered<Isa>(&records->x, list), at, factors), other(&values->x, list) {
    x = T(value.x) - T(other.x), y = T(value.y) - T(other.y), z = T(value.z) - T(other.z);
  }
  SOUPLE_INLINE T harmonic_mean(float own) const {
    return T(2 * own) * T(other.w) / max(T(own) + T(other.w), T(1e-30f));
  }
};

/// f(register, pair) for all neighbors of a list.
template <class Isa, class Function>
SOUPLE_INLINE inline void for_pairs(const Vec4f* records, const Vec4f* values, const Vec4f& at,
                                    const Vec4f& value, const std::uint32_t* list, std::size_t count,
                                    const SmoothingFactors& factors, const Function& f) {
  for (std::size_t k = 0; k < count; k += 16)
    for (int r = 0; r < Sixteen<Isa>::registers; ++r)
      f(r,
        Pair<Isa>(records, values, at, value, list + k + static_cast<std::size_t>(r * Isa::lanes), factors));
}

template <class Isa, class Shape>
Vec3f velocity_exchange(const Vec4f* records, const Vec4f* values, const Vec4f& at, const Vec4f& value,
                        const std::uint32_t* list, std::size_t count, const SmoothingFactors& factors) {
  using T = simd::Pack<Isa>;
  SixteenOfThree<Isa> sum;
  for_pairs<Isa>(records, values, at, value, list, count, factors, [&](int r, const Pair<Isa>& pair) {
    const T weight = pair.harmonic_mean(value.w) * (T(factors.value_factor) * Shape::value(pair.near.q));
    sum.add(r, weight * -pair.x, weight * -pair.y, weight * -pair.z);
  });
  return sum.total();
}

template <class Isa>
Vec3f velocity_strain(const Vec4f* records, const Vec4f* values, const Vec4f& at, const Vec4f& value,
                      const std::uint32_t* list, std::size_t count, const SmoothingFactors& factors) {
  using T = simd::Pack<Isa>;
  SixteenOfThree<Isa> sum;
  const T floor(1e-4f * factors.h * factors.h);
  for_pairs<Isa>(records, values, at, value, list, count, factors, [&](int r, const Pair<Isa>& pair) {
    const Near<Isa>& near = pair.near;
    const T along = pair.x * near.dx + pair.y * near.dy + pair.z * near.dz;
    const T weight = max(T(1.0f) - near.q, T(0.0f)) * pair.harmonic_mean(value.w);
    const T pull = weight * (along / (near.r2 + floor));
    sum.add(r, -pull * near.dx, -pull * near.dy, -pull * near.dz);
  });
  return sum.total();
}

template <class Isa, class Shape>
Vec3f velocity_curl(const Vec4f* records, const Vec4f* values, const Vec4f& at, const Vec4f& value,
                    const std::uint32_t* list, std::size_t count, const SmoothingFactors& factors) {
  using T = simd::Pack<Isa>;
  SixteenOfThree<Isa> sum;
  for_pairs<Isa>(records, values, at, value, list, count, factors, [&](int r, const Pair<Isa>& pair) {
    const Near<Isa>& near = pair.near;
    const T slope = T(factors.slope_factor) * Shape::slope(near.q);
    sum.add(r, slope * (near.dz * pair.y - near.dy * pair.z), slope * (near.dx * pair.z - near.dz * pair.x),
            slope * (near.dy * pair.x - near.dx * pair.y));
  });
  return sum.total();
}

template <class Isa>
float velocity_closing_speed(const Vec4f* records, const Vec4f* values, const Vec4f& at, const Vec4f& value,
                             const std::uint32_t* list, std::size_t count, const SmoothingFactors& factors) {
  using T = simd::Pack<Isa>;
  Sixteen<Isa> sum;
  for_pairs<Isa>(records, values, at, value, list, count, factors, [&](int r, const Pair<Isa>& pair) {
    const Near<Isa>& near = pair.near;
    const T along = pair.x * near.dx + pair.y * near.dy + pair.z * near.dz;
    const T speed = sqrt(pair.x * pair.x + pair.y * pair.y + pair.z * pair.z);
    sum.add(r, (speed - along / (T(factors.h) * near.q)) * max(T(1.0f) - near.q, T(0.0f)));
  });
  const FourLanes four = sum.four();
  return (four[0] + four[2]) + (four[1] + four[3]);
}

template <class Isa, class Shape>
Vec3f velocity_cohesion(const Vec4f* records, const Vec4f* values, const Vec4f& at, const Vec4f& value,
                        const std::uint32_t* list, std::size_t count, const SmoothingFactors& factors,
                        const CohesionFactors& cohesion) {
  using T = simd::Pack<Isa>;
  SixteenOfThree<Isa> sum;
  for_pairs<Isa>(records, values, at, value, list, count, factors, [&](int r, const Pair<Isa>& pair) {
    const Near<Isa>& near = pair.near;
    const T share = T(-2.0f) / (T(value.w) + T(pair.other.w));
    const T pull = share * (T(cohesion.attraction * factors.inverse_h) * Cohesion::slope(near.q));
    const T flatten = share * (T(cohesion.flattening) * Shape::value(near.q));
    sum.add(r, pull * near.dx + flatten * pair.x, pull * near.dy + flatten * pair.y,
            pull * near.dz + flatten * pair.z);
  });
  return sum.total();
}

template <class Isa, class Shape>
const VelocityKernels& velocity_kernels() {
  static constexpr VelocityKernels kernels{velocity_exchange<Isa, Shape>, velocity_strain<Isa>,
                                           velocity_curl<Isa, Shape>, velocity_closing_speed<Isa>,
                                           velocity_cohesion<Isa, Shape>};
  return kernels;
}

}  // namespace souple::kernels
