// Compiled once for each instruction set: see cmake/SoupleKernels.cmake.
#include "souple/contacts/kernels/compile_collider_contacts.h"
#include "souple/contacts/kernels/compile_collider_elements.h"
#include "souple/contacts/kernels/compile_element_pairs.h"
#include "souple/contacts/kernels/compile_vertex_balls.h"

namespace souple::kernels {

template const ColliderContactKernels& collider_contact_kernels<SOUPLE_ISA>();
template const ColliderElementKernels& collider_element_kernels<SOUPLE_ISA>();
template const ElementPairKernels& element_pair_kernels<SOUPLE_ISA>();
template const VertexBallKernels& vertex_ball_kernels<SOUPLE_ISA>();

}  // namespace souple::kernels
