#pragma once

#include "souple/solver/kernels/kernels.h"
#include "souple/solver/kernels/links.h"
#include "souple/solver/kernels/motion.h"
#include "souple/solver/kernels/triangles.h"

#include <string_view>
#include <type_traits>

namespace souple::kernels {

struct CellKernels;
/// See kernels/cells.h. Compiled in one translation unit per instruction set (kernels/compile_cells.h).
template <class Isa>
const CellKernels& cell_kernels();

}  // namespace souple::kernels

namespace souple {

/// The instruction sets for which kernels are compiled. All give the same bits.
enum class InstructionSet { scalar, sse, avx2, avx512, neon };

/// The widest instruction set that this build and this processor support, or the set that the environment
/// variable SOUPLE_SIMD names. Read once. Throws Error when SOUPLE_SIMD names an unknown or unsupported set.
InstructionSet instruction_set();

/// The name as in SOUPLE_SIMD.
std::string_view simd_name(InstructionSet set);
inline std::string_view simd_name() {
  return simd_name(instruction_set());
}

namespace detail {

/// find(tag of the set), or null if no kernels are compiled for it.
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

// Each returns null if there are no kernels: use the scalar code.

/// Kernels of a constraint kind for an instruction set.
template <class Kind>
const kernels::KindKernels* find_kernels(InstructionSet set) {
  if constexpr (kernels::is_compiled<Kind>)
    return detail::find_for(
        set, []<class Isa>(std::type_identity<Isa>) { return &kernels::kind_kernels<Isa, Kind>(); });
  return nullptr;
}

/// Kernels of the links of a coarse level.
inline const kernels::LinkKernels* find_link_kernels(InstructionSet set) {
  return detail::find_for(set,
                          []<class Isa>(std::type_identity<Isa>) { return &kernels::link_kernels<Isa>(); });
}

/// Kernels of the cells of a coarse lattice.
inline const kernels::CellKernels* find_cell_kernels(InstructionSet set) {
  return detail::find_for(set,
                          []<class Isa>(std::type_identity<Isa>) { return &kernels::cell_kernels<Isa>(); });
}

/// Kernels that move particles.
inline const kernels::MotionKernels* find_motion_kernels(InstructionSet set) {
  return detail::find_for(set,
                          []<class Isa>(std::type_identity<Isa>) { return &kernels::motion_kernels<Isa>(); });
}

/// Kernels of triangles: wind and normals.
inline const kernels::TriangleKernels* find_triangle_kernels(InstructionSet set) {
  return detail::find_for(
      set, []<class Isa>(std::type_identity<Isa>) { return &kernels::triangle_kernels<Isa>(); });
}

}  // namespace souple
