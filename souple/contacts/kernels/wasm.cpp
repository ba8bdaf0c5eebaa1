#if defined(__wasm_simd128__)

#include "souple/contacts/kernels/compile_collider_contacts.h"
#include "souple/contacts/kernels/compile_collider_elements.h"
#include "souple/contacts/kernels/compile_element_pairs.h"
#include "souple/contacts/kernels/compile_vertex_balls.h"

template const souple::kernels::ColliderContactKernels&
souple::kernels::collider_contact_kernels<souple::simd::Wasm>();
template const souple::kernels::ColliderElementKernels&
souple::kernels::collider_element_kernels<souple::simd::Wasm>();
template const souple::kernels::ElementPairKernels&
souple::kernels::element_pair_kernels<souple::simd::Wasm>();
template const souple::kernels::VertexBallKernels& souple::kernels::vertex_ball_kernels<souple::simd::Wasm>();

#endif
