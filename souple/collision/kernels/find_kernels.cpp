#include "souple/collision/kernels/find_kernels.h"

#include "souple/collision/kernels/single.h"

namespace souple::kernels {

const FeatureKernels& find_feature_kernels(InstructionSet set) {
  const FeatureKernels* const packed = souple::detail::find_for(
      set, []<class Isa>(std::type_identity<Isa>) { return &feature_kernels<Isa>(); });
  return packed ? *packed : feature_kernels<Single>();
}

}  // namespace souple::kernels
