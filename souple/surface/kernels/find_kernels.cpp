#include "souple/surface/kernels/surface_kernels.h"

namespace souple::kernels {

const SurfaceKernels& find_surface_kernels(InstructionSet set) {
  const SurfaceKernels* const packed = souple::detail::find_for(
      set, []<class Set>(std::type_identity<Set>) { return &surface_kernels<Set>(); });
  return packed ? *packed : surface_kernels<PlainLanes>();
}

}  // namespace souple::kernels
