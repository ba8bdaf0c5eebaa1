#include "souple/solver/kernels/compile.h"

namespace souple::kernels {

template struct Compile<simd::Neon, EveryConstraint>;

}  // namespace souple::kernels
