#include "souple/fluid/kernels/find_kernels.h"

namespace souple::kernels {

const NeighbourKernels& find_neighbour_kernels(InstructionSet set) {
  const NeighbourKernels* const packed = souple::detail::find_for(
      set, []<class Set>(std::type_identity<Set>) { return &neighbour_kernels<Set>(); });
  return packed ? *packed : neighbour_kernels<OneLane>();
}

}  // namespace souple::kernels
