#include "souple/fluid/kernels/compile_density.h"
#include "souple/fluid/kernels/compile_neighbors.h"
#include "souple/fluid/kernels/compile_velocity.h"

namespace souple::kernels {

template const NeighborKernels& neighbor_kernels<simd::Avx2>();
template const DensityKernels& density_kernels<simd::Avx2, Wendland>();
template const DensityKernels& density_kernels<simd::Avx2, Poly6Spiky>();
template const DensityKernels& density_kernels<simd::Avx2, CubicSpline>();
template const VelocityKernels& velocity_kernels<simd::Avx2, Wendland>();
template const VelocityKernels& velocity_kernels<simd::Avx2, Poly6Spiky>();
template const VelocityKernels& velocity_kernels<simd::Avx2, CubicSpline>();

}  // namespace souple::kernels
