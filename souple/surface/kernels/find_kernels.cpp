#include "souple/surface/kernels/find_kernels.h"

#include "souple/simd/find_for.h"

namespace souple::kernels {

const SurfaceKernels& find_surface_kernels(InstructionSet set) {
  return *souple::detail::find_for(
      set, []<class Isa>(std::type_identity<Isa>) { return &surface_kernels<Isa>(); });
}

}  // namespace souple::kernels
