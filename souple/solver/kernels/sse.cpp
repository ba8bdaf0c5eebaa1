#include "souple/solver/kernels/compile.h"
#include "souple/solver/kernels/compile_motion.h"

namespace souple::kernels {

template struct Compile<simd::Sse, EveryConstraint>;
template const MotionKernels& motion_kernels<simd::Sse>();

}  // namespace souple::kernels
