#if defined(__wasm_simd128__)

#include "souple/fluid/kernels/compile_density.h"
#include "souple/fluid/kernels/compile_neighbors.h"
#include "souple/fluid/kernels/compile_velocity.h"

namespace souple::kernels {

template const NeighborKernels& neighbor_kernels<simd::Wasm>();
template const DensityKernels& density_kernels<simd::Wasm, Wendland>();
template const DensityKernels& density_kernels<simd::Wasm, Poly6Spiky>();
template const DensityKernels& density_kernels<simd::Wasm, CubicSpline>();
template const VelocityKernels& velocity_kernels<simd::Wasm, Wendland>();
template const VelocityKernels& velocity_kernels<simd::Wasm, Poly6Spiky>();
template const VelocityKernels& velocity_kernels<simd::Wasm, CubicSpline>();

}  // namespace souple::kernels

#endif
