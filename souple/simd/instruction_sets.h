#pragma once

#if defined(__x86_64__)
#include <immintrin.h>
#elif defined(__aarch64__)
#include <arm_neon.h>
#elif defined(__wasm_simd128__)
#include <wasm_simd128.h>
#endif

#include <cstdint>
#include <utility>

// Operations that differ between instruction sets: the register width, square roots, and the gathering and
// transposing of four-float records. All other operations are compiler vectors (pack.h).
//
// Every template compiled for an instruction set has its tag as a parameter. So the linker never takes the code of one
// set for that of another.
//
// load_records: the four floats that begin at base + i[0], base + i[4], base + i[8], ... fill a register. So
// four
//   registers loaded from i, i + 1, i + 2, i + 3 transpose to components in the order of i.
// min, max: a < b ? a : b and a > b ? a : b.
// difference_but_last: a - b, but the fourth float of every record is that of a.
// broadcast_last: copies the fourth float of every record to all four.
// any: whether a lane of the mask is set. bits: bit l is set where lane l is.

/// Marks functions that must be inlined in code compiled for an instruction set.
#define SOUPLE_INLINE __attribute__((always_inline))

namespace souple::simd {

/// One lane: a register is a float. It runs on every processor, and it is what the others are tested against. A record
/// does not fit its register: simd/registers.h loads those for every set.
struct Scalar {
  static constexpr int lanes = 1;
  using Vector = float;
  using Mask = std::int32_t;

  static Vector broadcast(float a) { return a; }
  static bool any(Mask a) { return a != 0; }
  static std::uint32_t bits(Mask a) { return a != 0 ? 1 : 0; }
  static Vector sqrt(Vector a) { return __builtin_sqrtf(a); }
  static Vector min(Vector a, Vector b) { return a < b ? a : b; }
  static Vector max(Vector a, Vector b) { return a > b ? a : b; }
  static Vector load(const float* p) { return *p; }
  static void store(float* p, Vector a) { *p = a; }
};

/// The operations of registers of several lanes that read alike for every set. Compilers make them the instructions of the
/// set.
template <class Isa, int count>
struct Registers {
  static constexpr int lanes = count;
  using Vector __attribute__((vector_size(4 * count))) = float;
  using Mask __attribute__((vector_size(4 * count))) = std::int32_t;

  static Vector broadcast(float a) { return a - Vector{}; }
  static Vector load(const float* p) {
    Vector a;
    __builtin_memcpy(&a, p, sizeof a);
    return a;
  }
  static void store(float* p, Vector a) { __builtin_memcpy(p, &a, sizeof a); }
  static Vector difference_but_last(Vector a, Vector b) { return shuffle<0, 1, 2, 7>(a - b, a); }
  static Vector broadcast_last(Vector a) { return shuffle<3, 3, 3, 3>(a, a); }
  static Vector unpack_low(Vector a, Vector b) { return shuffle<0, 4, 1, 5>(a, b); }
  static Vector unpack_high(Vector a, Vector b) { return shuffle<2, 6, 3, 7>(a, b); }
  static Vector pair_low(Vector a, Vector b) { return shuffle<0, 1, 4, 5>(a, b); }
  static Vector pair_high(Vector a, Vector b) { return shuffle<2, 3, 6, 7>(a, b); }

 private:
  // The floats of each record: 0 to 3 are those of the record of a, 4 to 7 those of b.
  template <int... from>
  static Vector shuffle(Vector a, Vector b) {
    return [&]<int... lane>(std::integer_sequence<int, lane...>) SOUPLE_INLINE {
      constexpr int of[] = {from...};
      return __builtin_shufflevector(a, b, (lane / 4 * 4 + of[lane % 4] % 4 + of[lane % 4] / 4 * count)...);
    }
    (std::make_integer_sequence<int, count>{});
  }
};

#if defined(__SSE2__)
struct Sse : Registers<Sse, 4> {
  static bool any(Mask a) { return _mm_movemask_epi8((__m128i)a) != 0; }
  static std::uint32_t bits(Mask a) { return static_cast<std::uint32_t>(_mm_movemask_ps((__m128)a)); }
  static Vector sqrt(Vector a) { return _mm_sqrt_ps(a); }
  static Vector min(Vector a, Vector b) { return _mm_min_ps(a, b); }
  static Vector max(Vector a, Vector b) { return _mm_max_ps(a, b); }
  static Vector load_records(const float* base, const std::uint32_t* i) { return _mm_load_ps(base + i[0]); }
  static void store_records(float* base, const std::uint32_t* i, Vector a) { _mm_store_ps(base + i[0], a); }
  // Without SSE4.1's blend.
  static Vector difference_but_last(Vector a, Vector b) {
    const Vector d = a - b;
    return _mm_shuffle_ps(d, _mm_shuffle_ps(d, a, 0xEA), 0xC4);  // d.x d.y (d.z d.z a.z a.w)[0, 3]
  }
};
#endif

#if defined(__AVX2__)
struct Avx2 : Registers<Avx2, 8> {
  static bool any(Mask a) { return _mm256_movemask_epi8((__m256i)a) != 0; }
  static std::uint32_t bits(Mask a) { return static_cast<std::uint32_t>(_mm256_movemask_ps((__m256)a)); }
  static Vector sqrt(Vector a) { return _mm256_sqrt_ps(a); }
  static Vector min(Vector a, Vector b) { return _mm256_min_ps(a, b); }
  static Vector max(Vector a, Vector b) { return _mm256_max_ps(a, b); }
  static Vector load_records(const float* base, const std::uint32_t* i) {
    return _mm256_insertf128_ps(_mm256_castps128_ps256(_mm_load_ps(base + i[0])), _mm_load_ps(base + i[4]),
                                1);
  }
  static void store_records(float* base, const std::uint32_t* i, Vector a) {
    _mm_store_ps(base + i[0], _mm256_castps256_ps128(a));
    _mm_store_ps(base + i[4], _mm256_extractf128_ps(a, 1));
  }
};
#endif

#if defined(__AVX512F__) && defined(__AVX512DQ__)
struct Avx512 : Registers<Avx512, 16> {
  static bool any(Mask a) { return _mm512_movepi32_mask((__m512i)a) != 0; }
  static std::uint32_t bits(Mask a) { return _mm512_movepi32_mask((__m512i)a); }
  static Vector sqrt(Vector a) { return _mm512_sqrt_ps(a); }
  static Vector min(Vector a, Vector b) { return _mm512_min_ps(a, b); }
  static Vector max(Vector a, Vector b) { return _mm512_max_ps(a, b); }
  static Vector load_records(const float* base, const std::uint32_t* i) {
    const auto at = [base](std::uint32_t record) { return _mm_load_ps(base + record); };
    __m512 a = _mm512_castps128_ps512(at(i[0]));
    a = _mm512_insertf32x4(a, at(i[4]), 1);
    a = _mm512_insertf32x4(a, at(i[8]), 2);
    return _mm512_insertf32x4(a, at(i[12]), 3);
  }
  static void store_records(float* base, const std::uint32_t* i, Vector a) {
    const auto at = [base](std::uint32_t record) { return base + record; };
    _mm_store_ps(at(i[0]), _mm512_castps512_ps128(a));
    _mm_store_ps(at(i[4]), _mm512_extractf32x4_ps(a, 1));
    _mm_store_ps(at(i[8]), _mm512_extractf32x4_ps(a, 2));
    _mm_store_ps(at(i[12]), _mm512_extractf32x4_ps(a, 3));
  }
  static Vector difference_but_last(Vector a, Vector b) { return _mm512_mask_sub_ps(a, 0x7777, a, b); }
};
#endif

#if defined(__aarch64__)
struct Neon : Registers<Neon, 4> {
  static bool any(Mask a) { return vmaxvq_u32((uint32x4_t)a) != 0; }
  static std::uint32_t bits(Mask a) { return vaddvq_u32((uint32x4_t)a & uint32x4_t{1, 2, 4, 8}); }
  static Vector sqrt(Vector a) { return vsqrtq_f32(a); }
  static Vector min(Vector a, Vector b) { return a < b ? a : b; }
  static Vector max(Vector a, Vector b) { return a > b ? a : b; }
  static Vector load_records(const float* base, const std::uint32_t* i) { return vld1q_f32(base + i[0]); }
  static void store_records(float* base, const std::uint32_t* i, Vector a) { vst1q_f32(base + i[0], a); }
};
#endif

#if defined(__wasm_simd128__)
/// 128 bits of WebAssembly.
struct Wasm : Registers<Wasm, 4> {
  static bool any(Mask a) { return wasm_v128_any_true((v128_t)a); }
  static std::uint32_t bits(Mask a) { return static_cast<std::uint32_t>(wasm_i32x4_bitmask((v128_t)a)); }
  static Vector sqrt(Vector a) { return (Vector)wasm_f32x4_sqrt((v128_t)a); }
  // pmin(a, b) is b < a ? b : a, and pmax(a, b) is a < b ? b : a.
  static Vector min(Vector a, Vector b) { return (Vector)wasm_f32x4_pmin((v128_t)b, (v128_t)a); }
  static Vector max(Vector a, Vector b) { return (Vector)wasm_f32x4_pmax((v128_t)b, (v128_t)a); }
  static Vector load_records(const float* base, const std::uint32_t* i) { return load(base + i[0]); }
  static void store_records(float* base, const std::uint32_t* i, Vector a) { store(base + i[0], a); }
};
#endif

}  // namespace souple::simd
