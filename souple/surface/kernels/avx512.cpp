#include "souple/surface/kernels/compile_surface.h"

namespace souple::kernels {

template const SurfaceKernels& surface_kernels<simd::Avx512>();

}  // namespace souple::kernels
