#if defined(__aarch64__)

#include "souple/solver/kernels/compile.h"

namespace souple::kernels {

template struct Compile<simd::Neon, MeshConstraints>;

}  // namespace souple::kernels

#endif
