// Compiled once for each instruction set: see cmake/SoupleKernels.cmake.
#include "souple/surface/kernels/compile_surface.h"

namespace souple::kernels {

template const SurfaceKernels& surface_kernels<SOUPLE_ISA>();

}  // namespace souple::kernels
