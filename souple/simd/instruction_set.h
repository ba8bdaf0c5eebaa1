#pragma once

#include <string_view>

namespace souple::simd {

struct Scalar;
struct Sse;
struct Avx2;
struct Avx512;
struct Neon;
struct Wasm;

}  // namespace souple::simd

namespace souple {

/// The instruction sets for which kernels can be compiled (CMake: SOUPLE_INSTRUCTION_SETS). All give the same
/// bits.
enum class InstructionSet { scalar, sse, avx2, avx512, neon, wasm };

/// The widest instruction set that this build and this processor support, or the set that the environment
/// variable SOUPLE_SIMD names. Read once. Throws Error when SOUPLE_SIMD names an unknown or unsupported set.
InstructionSet instruction_set();

/// The name as in SOUPLE_SIMD.
std::string_view simd_name(InstructionSet set);
inline std::string_view simd_name() {
  return simd_name(instruction_set());
}

}  // namespace souple
