#include "souple/fluid/kernels/compile_density.h"
#include "souple/fluid/kernels/compile_neighbors.h"
#include "souple/fluid/kernels/compile_velocity.h"

namespace souple::kernels {

template const NeighborKernels& neighbor_kernels<simd::Sse>();
template const DensityKernels& density_kernels<simd::Sse, Wendland>();
template const DensityKernels& density_kernels<simd::Sse, Poly6Spiky>();
template const DensityKernels& density_kernels<simd::Sse, CubicSpline>();
template const VelocityKernels& velocity_kernels<simd::Sse, Wendland>();
template const VelocityKernels& velocity_kernels<simd::Sse, Poly6Spiky>();
template const VelocityKernels& velocity_kernels<simd::Sse, CubicSpline>();

}  // namespace souple::kernels
