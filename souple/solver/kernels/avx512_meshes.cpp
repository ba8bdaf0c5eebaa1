#include "souple/solver/kernels/compile.h"

namespace souple::kernels {

template struct Compile<simd::Avx512, MeshConstraints>;

}  // namespace souple::kernels
