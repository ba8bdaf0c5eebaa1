#include "souple/fluid/kernels/find_kernels.h"

namespace souple::kernels {

const NeighbourKernels& find_neighbour_kernels(InstructionSet set) {
  const NeighbourKernels* const packed = souple::detail::find_for(
      set, []<class Set>(std::type_identity<Set>) { return &neighbour_kernels<Set>(); });
  return packed ? *packed : neighbour_kernels<OneLane>();
}

const DensityKernels& find_density_kernels(InstructionSet set) {
  const DensityKernels* const packed = souple::detail::find_for(
      set, []<class Set>(std::type_identity<Set>) { return &density_kernels<Set>(); });
  return packed ? *packed : density_kernels<PlainLanes>();
}

}  // namespace souple::kernels
