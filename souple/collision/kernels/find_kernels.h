#pragma once

#include "souple/collision/kernels/element_pairs.h"
#include "souple/solver/instruction_set.h"

namespace souple::kernels {

/// Of an instruction set that this build and this processor have.
const ElementPairKernels& find_element_pair_kernels(InstructionSet set);

}  // namespace souple::kernels
