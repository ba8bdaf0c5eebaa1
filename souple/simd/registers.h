#pragma once

#include "souple/math/vec3.h"
#include "souple/simd/pack.h"

#include <cstddef>
#include <cstdint>

// Registers of contacts: loads, gathers and stores that the kernels of contacts share. Include this only in
// translation units that are compiled for one instruction set. Every template here has the tag of its instruction
// set as an argument.

namespace souple::kernels {

template <class Isa>
using Numbers = simd::Pack<Isa>;
template <class Isa>
using Vectors = Vec3<simd::Pack<Isa>>;

/// Four floats of each lane's record: as loaded, or, after `components`, one register per component.
template <class Isa>
struct Records {
  typename Isa::Vector r[4];

  Records() = default;
  SOUPLE_INLINE Records(const float* base, const std::uint32_t* first_float) {
    for (std::uint32_t j = 0; j < 4; ++j) {
      if constexpr (Isa::lanes == 1) {
        r[j] = base[first_float[0] + j];
      } else {
        r[j] = Isa::load_records(base, first_float + j);
      }
    }
  }
  SOUPLE_INLINE void add(const Records& b) {
    for (int j = 0; j < 4; ++j) r[j] = r[j] + b.r[j];
  }
  SOUPLE_INLINE void subtract(const Records& b) {
    for (int j = 0; j < 4; ++j) r[j] = r[j] - b.r[j];
  }
  /// Transposes back and writes.
  SOUPLE_INLINE void write(float* base, const std::uint32_t* first_float) {
    transpose();
    for (std::uint32_t j = 0; j < 4; ++j) {
      if constexpr (Isa::lanes == 1) {
        base[first_float[0] + j] = r[j];
      } else {
        Isa::store_records(base, first_float + j, r[j]);
      }
    }
  }
  SOUPLE_INLINE void transpose() {
    if constexpr (Isa::lanes > 1) simd::transpose<Isa>(r);
  }
  SOUPLE_INLINE Vectors<Isa> components() {
    transpose();
    return {Numbers<Isa>(r[0]), Numbers<Isa>(r[1]), Numbers<Isa>(r[2])};
  }
};

/// Indices i, i + 1, ... or the entries of a list from i on; lanes beyond the end repeat the last one.
template <class Isa>
struct Indices {
  std::uint32_t at[Isa::lanes];
  int count;  ///< lanes before the end

  SOUPLE_INLINE Indices(std::size_t i, std::size_t end, const std::uint32_t* list = nullptr)
      : count(end - i < Isa::lanes ? static_cast<int>(end - i) : Isa::lanes) {
    for (int lane = 0; lane < Isa::lanes; ++lane) {
      const std::size_t k = i + static_cast<std::size_t>(lane < count ? lane : count - 1);
      at[lane] = list ? list[k] : static_cast<std::uint32_t>(k);
    }
  }
};

template <class Isa>
SOUPLE_INLINE inline Numbers<Isa> gather(const float* column, const std::uint32_t (&index)[Isa::lanes]) {
  float lanes[Isa::lanes];
  for (int lane = 0; lane < Isa::lanes; ++lane) lanes[lane] = column[index[lane]];
  return Numbers<Isa>::load(lanes);
}

// Consecutive values of a column. Reads and writes no value beyond `count`.
template <class Isa>
SOUPLE_INLINE inline Numbers<Isa> load(const float* column, int count) {
  if (count == Isa::lanes) return Numbers<Isa>::load(column);
  float lanes[Isa::lanes];
  for (int lane = 0; lane < Isa::lanes; ++lane) lanes[lane] = column[lane < count ? lane : count - 1];
  return Numbers<Isa>::load(lanes);
}
template <class Isa>
SOUPLE_INLINE inline void store(Numbers<Isa> a, float* column, int count) {
  if (count == Isa::lanes) return a.store(column);
  float lanes[Isa::lanes];
  a.store(lanes);
  for (int lane = 0; lane < count; ++lane) column[lane] = lanes[lane];
}

template <class Isa>
SOUPLE_INLINE inline Vectors<Isa> load3(float* const (&column)[3], std::size_t i, int count) {
  return {load<Isa>(column[0] + i, count), load<Isa>(column[1] + i, count), load<Isa>(column[2] + i, count)};
}
template <class Isa>
SOUPLE_INLINE inline void store3(const Vectors<Isa>& v, float* const (&column)[3], std::size_t i, int count) {
  for (int axis = 0; axis < 3; ++axis) store<Isa>(v[axis], column[axis] + i, count);
}
/// Adds to the first three floats of records.
template <class Isa>
SOUPLE_INLINE inline void add_to_records(float* base, const std::uint32_t (&first_float)[Isa::lanes],
                                         const Vectors<Isa>& change) {
  Records<Isa> records(base, first_float);
  records.transpose();
  for (int axis = 0; axis < 3; ++axis) records.r[axis] = (Numbers<Isa>(records.r[axis]) + change[axis]).v;
  records.write(base, first_float);
}

template <class Isa>
SOUPLE_INLINE inline Vectors<Isa> selected(typename Numbers<Isa>::Mask mask, const Vectors<Isa>& a,
                                           const Vectors<Isa>& b) {
  return {select(mask, a.x, b.x), select(mask, a.y, b.y), select(mask, a.z, b.z)};
}

}  // namespace souple::kernels
