// Compiled once for each instruction set: see cmake/SoupleKernels.cmake.
#include "souple/fluid/kernels/compile_density.h"
#include "souple/fluid/kernels/compile_neighbors.h"
#include "souple/fluid/kernels/compile_velocity.h"

namespace souple::kernels {

template const NeighborKernels& neighbor_kernels<SOUPLE_ISA>();
template const DensityKernels& density_kernels<SOUPLE_ISA, Wendland>();
template const DensityKernels& density_kernels<SOUPLE_ISA, Poly6Spiky>();
template const DensityKernels& density_kernels<SOUPLE_ISA, CubicSpline>();
template const VelocityKernels& velocity_kernels<SOUPLE_ISA, Wendland>();
template const VelocityKernels& velocity_kernels<SOUPLE_ISA, Poly6Spiky>();
template const VelocityKernels& velocity_kernels<SOUPLE_ISA, CubicSpline>();

}  // namespace souple::kernels
