#pragma once

#include "souple/collision/patch_kernels/patch_kernels.h"
#include "souple/solver/instruction_set.h"

namespace souple::kernels {

/// Those of an instruction set; scalar code where there are none. Results are the same.
const PatchKernels& find_patch_kernels(InstructionSet set);

}  // namespace souple::kernels
