#pragma once

#include "souple/contacts/kernels/collider_contacts.h"
#include "souple/contacts/kernels/collider_elements.h"
#include "souple/contacts/kernels/element_pairs.h"
#include "souple/contacts/kernels/vertex_balls.h"
#include "souple/simd/instruction_set.h"

namespace souple::kernels {

/// Kernels for an instruction set that this build and this processor support.
const ElementPairKernels& find_element_pair_kernels(InstructionSet set);
const ColliderContactKernels& find_collider_contact_kernels(InstructionSet set);
const ColliderElementKernels& find_collider_element_kernels(InstructionSet set);
const VertexBallKernels& find_vertex_ball_kernels(InstructionSet set);

}  // namespace souple::kernels
