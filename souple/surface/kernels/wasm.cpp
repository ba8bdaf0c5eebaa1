#if defined(__wasm_simd128__)

#include "souple/surface/kernels/compile_surface.h"

namespace souple::kernels {

template const SurfaceKernels& surface_kernels<simd::Wasm>();

}  // namespace souple::kernels

#endif
