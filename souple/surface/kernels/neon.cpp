#if defined(__aarch64__)

#include "souple/surface/kernels/compile_surface.h"

namespace souple::kernels {

template const SurfaceKernels& surface_kernels<simd::Neon>();

}  // namespace souple::kernels

#endif
