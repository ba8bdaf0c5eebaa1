// Compiled once for each instruction set: see cmake/SoupleKernels.cmake.
#include "souple/broad_phase/kernels/compile.h"

namespace souple::kernels {

template const PatchKernels& patch_kernels<SOUPLE_ISA>();

}  // namespace souple::kernels
