#include "souple/broad_phase/kernels/find_kernels.h"

#include "souple/simd/find_for.h"

namespace souple::kernels {

// Groups are small, and the latency of AVX-512's mask registers exceeds their benefit: AVX-512 took 12 % more
// time than AVX2 (Zen 5, 100 k triangles).
const PatchKernels& find_patch_kernels(InstructionSet set) {
  return *souple::detail::find_for(set == InstructionSet::avx512 ? InstructionSet::avx2 : set,
                                   []<class Isa>(std::type_identity<Isa>) {
                                     if constexpr (std::is_same_v<Isa, simd::Avx512>) {
                                       return &patch_kernels<simd::Avx2>();
                                     } else {
                                       return &patch_kernels<Isa>();
                                     }
                                   });
}

}  // namespace souple::kernels
