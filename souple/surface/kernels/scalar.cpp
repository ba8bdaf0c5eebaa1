#include "souple/surface/kernels/compile_surface.h"

namespace souple::kernels {

template const SurfaceKernels& surface_kernels<simd::Scalar>();

}  // namespace souple::kernels
