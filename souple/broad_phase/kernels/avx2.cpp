#include "souple/broad_phase/kernels/compile.h"

namespace souple::kernels {

template const PatchKernels& patch_kernels<simd::Avx2>();

}  // namespace souple::kernels
