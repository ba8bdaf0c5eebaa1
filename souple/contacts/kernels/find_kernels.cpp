#include "souple/contacts/kernels/find_kernels.h"

#include "souple/contacts/kernels/single.h"
#include "souple/simd/find_for.h"

namespace souple::kernels {

const ElementPairKernels& find_element_pair_kernels(InstructionSet set) {
  const ElementPairKernels* const packed = souple::detail::find_for(
      set, []<class Isa>(std::type_identity<Isa>) { return &element_pair_kernels<Isa>(); });
  return packed ? *packed : element_pair_kernels<Single>();
}

const ColliderContactKernels& find_collider_contact_kernels(InstructionSet set) {
  const ColliderContactKernels* const packed = souple::detail::find_for(
      set, []<class Isa>(std::type_identity<Isa>) { return &collider_contact_kernels<Isa>(); });
  return packed ? *packed : collider_contact_kernels<Single>();
}

const ColliderElementKernels& find_collider_element_kernels(InstructionSet set) {
  const ColliderElementKernels* const packed = souple::detail::find_for(
      set, []<class Isa>(std::type_identity<Isa>) { return &collider_element_kernels<Isa>(); });
  return packed ? *packed : collider_element_kernels<Single>();
}

}  // namespace souple::kernels
