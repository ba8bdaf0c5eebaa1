#include "souple/broad_phase/kernels/find_kernels.h"

#include "souple/compiled_sets.h"

namespace souple::kernels {

// Groups are small, and the latency of AVX-512's mask registers exceeds their benefit: AVX-512 took 12 % more
// time than AVX2 (Zen 5, 100 k triangles).
const PatchKernels& find_patch_kernels(InstructionSet set) {
  switch (set) {
#if SOUPLE_HAS_SSE
    case InstructionSet::sse:
      return patch_kernels<simd::Sse>();
#endif
#if SOUPLE_HAS_AVX2
    case InstructionSet::avx2:
    case InstructionSet::avx512:
      return patch_kernels<simd::Avx2>();
#endif
#if SOUPLE_HAS_NEON
    case InstructionSet::neon:
      return patch_kernels<simd::Neon>();
#endif
    default:
      return patch_kernels<Scalar>();
  }
}

}  // namespace souple::kernels
