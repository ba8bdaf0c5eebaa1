#pragma once

#include "souple/collision/kernels/features.h"
#include "souple/solver/instruction_set.h"

namespace souple::kernels {

/// Of an instruction set that this build and this processor have.
const FeatureKernels& find_feature_kernels(InstructionSet set);

}  // namespace souple::kernels
