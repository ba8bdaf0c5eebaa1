#if defined(__aarch64__)

#include "souple/collision/patch_kernels/compile.h"

namespace souple::kernels {

template const PatchKernels& patch_kernels<simd::Neon>();

}  // namespace souple::kernels

#endif
