#if defined(__aarch64__)

#include "souple/fluid/kernels/compile_density.h"
#include "souple/fluid/kernels/compile_neighbors.h"
#include "souple/fluid/kernels/compile_velocity.h"

namespace souple::kernels {

template const NeighborKernels& neighbor_kernels<simd::Neon>();
template const DensityKernels& density_kernels<simd::Neon, Wendland>();
template const DensityKernels& density_kernels<simd::Neon, Poly6Spiky>();
template const DensityKernels& density_kernels<simd::Neon, CubicSpline>();
template const VelocityKernels& velocity_kernels<simd::Neon, Wendland>();
template const VelocityKernels& velocity_kernels<simd::Neon, Poly6Spiky>();
template const VelocityKernels& velocity_kernels<simd::Neon, CubicSpline>();

}  // namespace souple::kernels

#endif
