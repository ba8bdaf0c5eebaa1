#if defined(__aarch64__)

#include "souple/broad_phase/kernels/compile.h"

namespace souple::kernels {

template const PatchKernels& patch_kernels<simd::Neon>();

}  // namespace souple::kernels

#endif
