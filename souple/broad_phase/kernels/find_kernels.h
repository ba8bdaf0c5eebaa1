#pragma once

#include "souple/broad_phase/kernels/patch_kernels.h"
#include "souple/simd/instruction_set.h"

namespace souple::kernels {

/// Kernels for an instruction set; scalar code where it has none. Results are the same for all sets.
const PatchKernels& find_patch_kernels(InstructionSet set);

}  // namespace souple::kernels
