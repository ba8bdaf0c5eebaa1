#if defined(__wasm_simd128__)

#include "souple/broad_phase/kernels/compile.h"

namespace souple::kernels {

template const PatchKernels& patch_kernels<simd::Wasm>();

}  // namespace souple::kernels

#endif
