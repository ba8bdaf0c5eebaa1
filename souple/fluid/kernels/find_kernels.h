#pragma once

#include "souple/fluid/kernels/density_kernels.h"
#include "souple/fluid/kernels/neighbor_kernels.h"
#include "souple/fluid/kernels/velocity_kernels.h"
#include "souple/fluid/smoothing_shape.h"
#include "souple/simd/instruction_set.h"

namespace souple::kernels {

// The kernels of an instruction set, or scalar code if it has none. All give identical results.

const NeighborKernels& find_neighbor_kernels(InstructionSet set);
const DensityKernels& find_density_kernels(InstructionSet set, SmoothingShape shape);
const VelocityKernels& find_velocity_kernels(InstructionSet set, SmoothingShape shape);

}  // namespace souple::kernels
