#pragma once

#include "souple/fluid/kernels/neighbor_kernels.h"
#include "souple/simd/instruction_sets.h"

#include <array>
#include <cstring>

// Included only by translation units compiled for one instruction set; every template carries the set's tag.

namespace souple::kernels {

/// For each mask of lanes (bit l for lane l): its lane numbers times four, ascending, and their count.
template <class Isa, class Number>
struct LaneTable {
  std::array<std::array<Number, Isa::lanes>, 1u << Isa::lanes> lanes{};
  std::array<std::uint8_t, 1u << Isa::lanes> count{};
  constexpr LaneTable() {
    for (unsigned bits = 0; bits < lanes.size(); ++bits)
      for (unsigned l = 0; l < Isa::lanes; ++l)
        if ((bits >> l & 1) != 0) lanes[bits][count[bits]++] = static_cast<Number>(4 * l);
  }
};

/// Output of lane numbers.
template <class Isa>
struct Hits {
  using Mask = typename Isa::Mask;

  /// Writes 4 (first + l) for each lane l of `bits`, as a whole register. Returns their count.
  static std::uint32_t append(std::uint32_t first, std::uint32_t bits, std::uint32_t* found) {
#if defined(__AVX512F__) && defined(__AVX512DQ__)
    if constexpr (Isa::lanes == 16) {
      const __m512i numbers =
          _mm512_add_epi32(_mm512_set1_epi32(static_cast<int>(4 * first)),
                           _mm512_setr_epi32(0, 4, 8, 12, 16, 20, 24, 28, 32, 36, 40, 44, 48, 52, 56, 60));
      _mm512_storeu_si512(found, _mm512_maskz_compress_epi32(static_cast<__mmask16>(bits), numbers));
      return static_cast<std::uint32_t>(__builtin_popcount(bits));
    } else
#endif
#if defined(__AVX2__)
        if constexpr (Isa::lanes == 8) {
      static constexpr LaneTable<Isa, std::uint8_t> table;
      const __m128i bytes = _mm_loadl_epi64(reinterpret_cast<const __m128i*>(table.lanes[bits].data()));
      const __m256i numbers =
          _mm256_add_epi32(_mm256_cvtepu8_epi32(bytes), _mm256_set1_epi32(static_cast<int>(4 * first)));
      _mm256_storeu_si256(reinterpret_cast<__m256i*>(found), numbers);
      return table.count[bits];
    } else
#endif
    {
      static constexpr LaneTable<Isa, std::int32_t> table;
      Mask numbers;
      std::memcpy(&numbers, table.lanes[bits].data(), sizeof numbers);
      numbers += static_cast<std::int32_t>(4 * first);
      std::memcpy(found, &numbers, sizeof numbers);
      return table.count[bits];
    }
  }
};

template <class Isa>
std::uint32_t near_point(const PointColumns& points, std::uint32_t i, const IndexRange* ranges,
                         std::size_t range_count, float radius_squared, std::uint32_t* found) {
  using Vector = typename Isa::Vector;
  const float *x = points.component[0], *y = points.component[1], *z = points.component[2];
  const Vector xi = Isa::broadcast(x[i]), yi = Isa::broadcast(y[i]), zi = Isa::broadcast(z[i]);
  const Vector r2 = Isa::broadcast(radius_squared);
  std::uint32_t* out = found;
  for (std::size_t r = 0; r < range_count; ++r) {
    for (std::uint32_t k = ranges[r].begin; k < ranges[r].end; k += Isa::lanes) {
      const Vector dx = Isa::load(x + k) - xi, dy = Isa::load(y + k) - yi, dz = Isa::load(z + k) - zi;
      const Vector d2 = dx * dx + dy * dy + dz * dz;
      std::uint32_t bits = Isa::bits(d2 < r2);
      const std::uint32_t left = ranges[r].end - k;
      bits &= left < Isa::lanes ? (1u << left) - 1 : ~0u;
      const std::uint32_t self = i - k;
      bits &= ~(self < Isa::lanes ? 1u << self : 0u);
      out += Hits<Isa>::append(k, bits, out);
    }
  }
  return static_cast<std::uint32_t>(out - found);
}

template <class Isa>
const NeighborKernels& neighbor_kernels() {
  static constexpr NeighborKernels kernels{near_point<Isa>};
  return kernels;
}

}  // namespace souple::kernels
