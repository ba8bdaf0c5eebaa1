// Compiled once for each instruction set: see cmake/SoupleKernels.cmake.
#include "souple/solver/kernels/compile.h"
#include "souple/solver/kernels/compile_cells.h"
#include "souple/solver/kernels/compile_links.h"
#include "souple/solver/kernels/compile_motion.h"
#include "souple/solver/kernels/compile_triangles.h"

namespace souple::kernels {

template struct Compile<SOUPLE_ISA, OtherConstraints>;
template const CellKernels& cell_kernels<SOUPLE_ISA>();
template const LinkKernels& link_kernels<SOUPLE_ISA>();
template const MotionKernels& motion_kernels<SOUPLE_ISA>();
template const TriangleKernels& triangle_kernels<SOUPLE_ISA>();

}  // namespace souple::kernels
