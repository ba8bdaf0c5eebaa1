#pragma once

#include "souple/compiled_sets.h"
#include "souple/simd/instruction_set.h"

#include <type_traits>

namespace souple::detail {

/// find(tag of the set); that of simd::Scalar where this build has no kernels for it. Only what includes this header
/// is compiled again when SOUPLE_INSTRUCTION_SETS changes.
template <class Find>
auto find_for(InstructionSet set, const Find& find) {
  switch (set) {
#if SOUPLE_HAS_SSE
    case InstructionSet::sse:
      return find(std::type_identity<simd::Sse>{});
#endif
#if SOUPLE_HAS_AVX2
    case InstructionSet::avx2:
      return find(std::type_identity<simd::Avx2>{});
#endif
#if SOUPLE_HAS_AVX512
    case InstructionSet::avx512:
      return find(std::type_identity<simd::Avx512>{});
#endif
#if SOUPLE_HAS_NEON
    case InstructionSet::neon:
      return find(std::type_identity<simd::Neon>{});
#endif
#if SOUPLE_HAS_WASM
    case InstructionSet::wasm:
      return find(std::type_identity<simd::Wasm>{});
#endif
    default:
      return find(std::type_identity<simd::Scalar>{});
  }
}

}  // namespace souple::detail
