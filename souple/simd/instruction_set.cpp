#include "souple/simd/instruction_set.h"

#include "souple/compiled_sets.h"
#include "souple/error.h"

#include <array>
#include <cstdlib>
#include <string>

namespace souple {
namespace {

constexpr std::array all{InstructionSet::scalar, InstructionSet::sse,  InstructionSet::avx2,
                         InstructionSet::avx512, InstructionSet::neon, InstructionSet::wasm};

/// Compiled, and known to this processor.
bool is_supported(InstructionSet set) {
  switch (set) {
#if defined(__x86_64__)
    case InstructionSet::sse:
      return SOUPLE_HAS_SSE != 0;  // SSE2 is part of x86-64
    case InstructionSet::avx2:
      return SOUPLE_HAS_AVX2 != 0 && __builtin_cpu_supports("avx2") != 0;
    case InstructionSet::avx512:
      return SOUPLE_HAS_AVX512 != 0 && __builtin_cpu_supports("avx512f") != 0 &&
             __builtin_cpu_supports("avx512dq") != 0;
#elif defined(__aarch64__)
    case InstructionSet::neon:
      return SOUPLE_HAS_NEON != 0;
#elif defined(__wasm_simd128__)
    case InstructionSet::wasm:
      return SOUPLE_HAS_WASM != 0;  // without it no browser loads the module
#endif
    default:
      return set == InstructionSet::scalar;
  }
}

InstructionSet widest() {
  InstructionSet result = InstructionSet::scalar;
  for (const InstructionSet set : all)
    if (is_supported(set)) result = set;
  return result;
}

InstructionSet chosen() {
  const char* wanted = std::getenv("SOUPLE_SIMD");
  if (!wanted || *wanted == '\0') return widest();
  std::string available;
  for (const InstructionSet set : all) {
    if (!is_supported(set)) continue;
    if (simd_name(set) == wanted) return set;
    available += (available.empty() ? "" : ", ") + std::string(simd_name(set));
  }
  throw Error("SOUPLE_SIMD is '" + std::string(wanted) + "': expected one of " + available +
              ", which this build and this processor support");
}

}  // namespace

std::string_view simd_name(InstructionSet set) {
  constexpr std::array<std::string_view, all.size()> names{"scalar", "sse", "avx2", "avx512", "neon", "wasm"};
  return names[static_cast<std::size_t>(set)];
}

InstructionSet instruction_set() {
  static const InstructionSet set = chosen();
  return set;
}

}  // namespace souple
