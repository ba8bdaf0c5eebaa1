#pragma once

#include "souple/collision/patch_kernels/patch_kernels.h"
#include "souple/solver/instruction_set.h"

namespace souple::kernels {

/// Kernels for an instruction set; scalar code where it has none. Results are the same for all sets.
const PatchKernels& find_patch_kernels(InstructionSet set);

}  // namespace souple::kernels
