// Compiled once for each instruction set: see cmake/SoupleKernels.cmake.
#include "souple/solver/kernels/compile.h"

namespace souple::kernels {

template struct Compile<SOUPLE_ISA, MeshConstraints>;

}  // namespace souple::kernels
