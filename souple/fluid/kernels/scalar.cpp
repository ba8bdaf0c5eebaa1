#include "souple/fluid/kernels/compile_density.h"
#include "souple/fluid/kernels/compile_neighbors.h"
#include "souple/fluid/kernels/compile_velocity.h"

namespace souple::kernels {

template const NeighborKernels& neighbor_kernels<simd::Scalar>();
template const DensityKernels& density_kernels<simd::Scalar, Wendland>();
template const DensityKernels& density_kernels<simd::Scalar, Poly6Spiky>();
template const DensityKernels& density_kernels<simd::Scalar, CubicSpline>();
template const VelocityKernels& velocity_kernels<simd::Scalar, Wendland>();
template const VelocityKernels& velocity_kernels<simd::Scalar, Poly6Spiky>();
template const VelocityKernels& velocity_kernels<simd::Scalar, CubicSpline>();

}  // namespace souple::kernels
