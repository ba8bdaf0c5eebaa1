#include "souple/solver/kernels/compile.h"

namespace souple::kernels {

template struct Compile<simd::Sse, MeshConstraints>;

}  // namespace souple::kernels
