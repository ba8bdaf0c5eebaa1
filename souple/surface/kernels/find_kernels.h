#pragma once

#include "souple/simd/instruction_set.h"
#include "souple/surface/kernels/surface_kernels.h"

namespace souple::kernels {

/// The kernels of an instruction set; scalar code where it has none. Results are the same bits.
const SurfaceKernels& find_surface_kernels(InstructionSet set);

}  // namespace souple::kernels
