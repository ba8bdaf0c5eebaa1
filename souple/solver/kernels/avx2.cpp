#include "souple/solver/kernels/compile.h"

namespace souple::kernels {

template struct Compile<simd::Avx2, EveryConstraint>;

}  // namespace souple::kernels
