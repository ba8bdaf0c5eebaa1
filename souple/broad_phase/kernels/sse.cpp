#include "souple/broad_phase/kernels/compile.h"

namespace souple::kernels {

template const PatchKernels& patch_kernels<simd::Sse>();

}  // namespace souple::kernels
