#pragma once

#include "souple/solver/kernels/kernels.h"
#include "souple/solver/kernels/links.h"
#include "souple/solver/kernels/motion.h"
#include "souple/solver/kernels/triangles.h"

#include <string_view>

namespace souple::kernels {

struct CellKernels;
/// See kernels/cells.h. Compiled in one translation unit per instruction set (kernels/compile_cells.h).
template <class Isa>
const CellKernels& cell_kernels();

}  // namespace souple::kernels

namespace souple {

/// The instruction sets for which kernels can be compiled (CMake: SOUPLE_INSTRUCTION_SETS). All give the same
/// bits.
enum class InstructionSet { scalar, sse, avx2, avx512, neon };

/// The widest instruction set that this build and this processor support, or the set that the environment
/// variable SOUPLE_SIMD names. Read once. Throws Error when SOUPLE_SIMD names an unknown or unsupported set.
InstructionSet instruction_set();

/// The name as in SOUPLE_SIMD.
std::string_view simd_name(InstructionSet set);
inline std::string_view simd_name() {
  return simd_name(instruction_set());
}

// Each returns null if there are no kernels for the set: use the scalar code.

namespace detail {
/// Instantiated for every kind that is compiled, in find_kernels.cpp.
template <class Kind>
const kernels::KindKernels* find_compiled(InstructionSet set);
}  // namespace detail

/// Kernels of a constraint kind for an instruction set.
template <class Kind>
const kernels::KindKernels* find_kernels(InstructionSet set) {
  if constexpr (kernels::is_compiled<Kind>) return detail::find_compiled<Kind>(set);
  return nullptr;
}

/// Kernels of the links of a coarse level.
const kernels::LinkKernels* find_link_kernels(InstructionSet set);
/// Kernels of the cells of a coarse lattice.
const kernels::CellKernels* find_cell_kernels(InstructionSet set);
/// Kernels that move particles.
const kernels::MotionKernels* find_motion_kernels(InstructionSet set);
/// Kernels of triangles: wind and normals.
const kernels::TriangleKernels* find_triangle_kernels(InstructionSet set);

}  // namespace souple
