#include "souple/contacts/kernels/find_kernels.h"

#include "souple/simd/find_for.h"

namespace souple::kernels {

const ElementPairKernels& find_element_pair_kernels(InstructionSet set) {
  return *souple::detail::find_for(
      set, []<class Isa>(std::type_identity<Isa>) { return &element_pair_kernels<Isa>(); });
}

const ColliderContactKernels& find_collider_contact_kernels(InstructionSet set) {
  return *souple::detail::find_for(
      set, []<class Isa>(std::type_identity<Isa>) { return &collider_contact_kernels<Isa>(); });
}

const ColliderElementKernels& find_collider_element_kernels(InstructionSet set) {
  return *souple::detail::find_for(
      set, []<class Isa>(std::type_identity<Isa>) { return &collider_element_kernels<Isa>(); });
}

const VertexBallKernels& find_vertex_ball_kernels(InstructionSet set) {
  return *souple::detail::find_for(
      set, []<class Isa>(std::type_identity<Isa>) { return &vertex_ball_kernels<Isa>(); });
}

}  // namespace souple::kernels
