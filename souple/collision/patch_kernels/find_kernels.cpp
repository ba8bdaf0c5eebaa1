#include "souple/collision/patch_kernels/find_kernels.h"

namespace souple::kernels {

const PatchKernels& find_patch_kernels(InstructionSet set) {
  const PatchKernels* kernels =
      souple::detail::find_for(set, []<class Set>(std::type_identity<Set>) { return &patch_kernels<Set>(); });
  return kernels != nullptr ? *kernels : patch_kernels<Scalar>();
}

}  // namespace souple::kernels
