#include "souple/broad_phase/kernels/compile.h"

namespace souple::kernels {

template const PatchKernels& patch_kernels<simd::Scalar>();

}  // namespace souple::kernels
