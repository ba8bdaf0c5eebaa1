#pragma once

#include "souple/simd/pack.h"
#include "souple/solver/kernels/triangles.h"

// Included only by translation units that are compiled for one instruction set; every template here has the
// tag of that instruction set as parameter.

namespace souple::kernels {

/// The corners of one register of triangles, and the destinations of their results.
template <class Isa>
struct TriangleRecords {
  std::uint32_t corner[3][Isa::lanes], result[Isa::lanes];

  TriangleRecords(const TriangleArrays& a, std::size_t i) {
    for (std::size_t lane = 0; lane < Isa::lanes; ++lane) {
      for (std::size_t k = 0; k < 3; ++k) corner[k][lane] = 4 * (a.first + a.triangles[i + lane][k]);
      result[lane] = static_cast<std::uint32_t>(4 * lane);
    }
  }
};

/// Loads records by `load(j)` and transposes them to three components.
template <class Isa, class Load>
inline Vec3<simd::Pack<Isa>> load_transposed(const Load& load) {
  typename Isa::Vector r[4] = {load(0), load(1), load(2), load(3)};
  simd::transpose<Isa>(r);
  return {simd::Pack<Isa>(r[0]), simd::Pack<Isa>(r[1]), simd::Pack<Isa>(r[2])};
}

/// Corner k minus corner 0.
template <class Isa>
inline Vec3<simd::Pack<Isa>> side(const TriangleArrays& a, const TriangleRecords<Isa>& records, int k) {
  return load_transposed<Isa>([&](int j) {
    return Isa::load_records(a.position, records.corner[k] + j) -
           Isa::load_records(a.position, records.corner[0] + j);
  });
}

template <class Isa>
inline void store(const TriangleArrays& a, const TriangleRecords<Isa>& records, std::size_t i,
                  const Vec3<simd::Pack<Isa>>& v, const simd::Pack<Isa>& w = simd::Pack<Isa>(0)) {
  typename Isa::Vector r[4] = {v.x.v, v.y.v, v.z.v, w.v};
  simd::transpose<Isa>(r);
  for (int j = 0; j < 4; ++j) Isa::store_records(a.result + 4 * i, records.result + j, r[j]);
}

template <class Isa>
[[gnu::flatten]] std::size_t air_forces(const TriangleArrays& a, const Air& air, std::size_t i,
                                        std::size_t end) {
  using T = simd::Pack<Isa>;
  const Vec3<T> wind{T(air.wind[0]), T(air.wind[1]), T(air.wind[2])};
  for (; i + Isa::lanes <= end; i += Isa::lanes) {
    const TriangleRecords<Isa> records(a, i);
    const Vec3<T> sum = load_transposed<Isa>([&](int j) {
      return Isa::load_records(a.velocity, records.corner[0] + j) +
             Isa::load_records(a.velocity, records.corner[1] + j) +
             Isa::load_records(a.velocity, records.corner[2] + j);
    });
    const Vec3<T> v = sum * T(1.0f / 3) - wind;
    const T speed = sqrt(dot(v, v));
    const Vec3<T> force = air_force(side<Isa>(a, records, 1), side<Isa>(a, records, 2), v, speed, air);
    store(a, records, i, force * T(1.0f / 3), speed);
  }
  return i;
}

template <class Isa>
[[gnu::flatten]] std::size_t area_normals(const TriangleArrays& a, std::size_t i, std::size_t end) {
  for (; i + Isa::lanes <= end; i += Isa::lanes) {
    const TriangleRecords<Isa> records(a, i);
    store(a, records, i, cross(side<Isa>(a, records, 1), side<Isa>(a, records, 2)));
  }
  return i;
}

template <class Isa>
const TriangleKernels& triangle_kernels() {
  static constexpr TriangleKernels kernels{air_forces<Isa>, area_normals<Isa>};
  return kernels;
}

}  // namespace souple::kernels
