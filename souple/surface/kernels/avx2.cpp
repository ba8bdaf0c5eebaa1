#include "souple/surface/kernels/compile_surface.h"

namespace souple::kernels {

template const SurfaceKernels& surface_kernels<simd::Avx2>();

}  // namespace souple::kernels
