#pragma once

#include "souple/solver/kernels/kernels.h"
#include "souple/solver/kernels/motion.h"

#include <string_view>

namespace souple {

/// The instruction sets that kernels are compiled for. Results are the same bits with each.
enum class InstructionSet { scalar, sse, avx2, avx512, neon };

/// The widest that this build and this processor have, or the one that the environment variable SOUPLE_SIMD
/// names. Read once. Throws Error where SOUPLE_SIMD names none, or one that is not there.
InstructionSet instruction_set();

/// As SOUPLE_SIMD names it.
std::string_view simd_name(InstructionSet set);
inline std::string_view simd_name() {
  return simd_name(instruction_set());
}

/// The kernels of a kind for an instruction set, or null: use the scalar code.
template <class Kind>
const kernels::KindKernels* find_kernels(InstructionSet set) {
  if constexpr (kernels::is_compiled<Kind>) {
    switch (set) {
#if defined(__x86_64__)
      case InstructionSet::sse:
        return &kernels::kind_kernels<simd::Sse, Kind>();
      case InstructionSet::avx2:
        return &kernels::kind_kernels<simd::Avx2, Kind>();
      case InstructionSet::avx512:
        return &kernels::kind_kernels<simd::Avx512, Kind>();
#elif defined(__aarch64__)
      case InstructionSet::neon:
        return &kernels::kind_kernels<simd::Neon, Kind>();
#endif
      default:
        break;
    }
  }
  return nullptr;
}

/// The kernels that move particles, for an instruction set, or null: use the scalar code.
const kernels::MotionKernels* find_motion_kernels(InstructionSet set);

}  // namespace souple
