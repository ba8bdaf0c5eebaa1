#pragma once

#include "souple/solver/kernels/kernels.h"
#include "souple/solver/kernels/motion.h"
#include "souple/solver/kernels/triangles.h"

#include <string_view>
#include <type_traits>

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

namespace detail {

/// find(the set's tag), or null where kernels are not compiled.
template <class Find>
auto find_for(InstructionSet set, const Find& find) {
  switch (set) {
#if defined(__x86_64__)
    case InstructionSet::sse:
      return find(std::type_identity<simd::Sse>{});
    case InstructionSet::avx2:
      return find(std::type_identity<simd::Avx2>{});
    case InstructionSet::avx512:
      return find(std::type_identity<simd::Avx512>{});
#elif defined(__aarch64__)
    case InstructionSet::neon:
      return find(std::type_identity<simd::Neon>{});
#endif
    default:
      return decltype(find(std::type_identity<simd::Sse>{})){};
  }
}

}  // namespace detail

// Each gives null where there are none: use the scalar code.

/// The kernels of a kind of constraints for an instruction set.
template <class Kind>
const kernels::KindKernels* find_kernels(InstructionSet set) {
  if constexpr (kernels::is_compiled<Kind>)
    return detail::find_for(
        set, []<class Isa>(std::type_identity<Isa>) { return &kernels::kind_kernels<Isa, Kind>(); });
  return nullptr;
}

/// The kernels that move particles.
inline const kernels::MotionKernels* find_motion_kernels(InstructionSet set) {
  return detail::find_for(set,
                          []<class Isa>(std::type_identity<Isa>) { return &kernels::motion_kernels<Isa>(); });
}

/// The kernels of triangles: wind and normals.
inline const kernels::TriangleKernels* find_triangle_kernels(InstructionSet set) {
  return detail::find_for(
      set, []<class Isa>(std::type_identity<Isa>) { return &kernels::triangle_kernels<Isa>(); });
}

}  // namespace souple
