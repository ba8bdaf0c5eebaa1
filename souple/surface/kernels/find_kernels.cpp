#include "souple/surface/kernels/find_kernels.h"

#include "souple/simd/find_for.h"

namespace souple::kernels {

const SurfaceKernels& find_surface_kernels(InstructionSet set) {
  const SurfaceKernels* const packed = souple::detail::find_for(
      set, []<class Isa>(std::type_identity<Isa>) { return &surface_kernels<Isa>(); });
  return packed ? *packed : surface_kernels<PlainLanes>();
}

}  // namespace souple::kernels
