#pragma once

#include "souple/simd/instruction_set.h"
#include "souple/solver/kernels/kernels.h"

namespace souple::kernels {

struct CellKernels;
struct LinkKernels;
struct MotionKernels;
struct TriangleKernels;

}  // namespace souple::kernels

namespace souple {

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

/// Kernels of the links of a coarse level (kernels/links.h).
const kernels::LinkKernels* find_link_kernels(InstructionSet set);
/// Kernels of the cells of a coarse lattice (kernels/cells.h).
const kernels::CellKernels* find_cell_kernels(InstructionSet set);
/// Kernels that move particles (kernels/motion.h).
const kernels::MotionKernels* find_motion_kernels(InstructionSet set);
/// Kernels of triangles: wind and normals (kernels/triangles.h).
const kernels::TriangleKernels* find_triangle_kernels(InstructionSet set);

}  // namespace souple
