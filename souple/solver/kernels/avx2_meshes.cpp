#include "souple/solver/kernels/compile.h"

namespace souple::kernels {

template struct Compile<simd::Avx2, MeshConstraints>;

}  // namespace souple::kernels
