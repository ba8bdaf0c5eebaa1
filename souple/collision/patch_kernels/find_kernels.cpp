#include "souple/collision/patch_kernels/find_kernels.h"

namespace souple::kernels {

// Groups are small, and the latency of AVX-512's mask registers exceeds their benefit: AVX-512 took 12 % more
// time than AVX2 (Zen 5, 100 k triangles).
const PatchKernels& find_patch_kernels(InstructionSet set) {
  switch (set) {
#if defined(__x86_64__)
    case InstructionSet::sse:
      return patch_kernels<simd::Sse>();
    case InstructionSet::avx2:
    case InstructionSet::avx512:
      return patch_kernels<simd::Avx2>();
#elif defined(__aarch64__)
    case InstructionSet::neon:
      return patch_kernels<simd::Neon>();
#endif
    default:
      return patch_kernels<Scalar>();
  }
}

}  // namespace souple::kernels
