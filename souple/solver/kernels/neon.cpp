#if defined(__aarch64__)

#include "souple/solver/kernels/compile.h"
#include "souple/solver/kernels/compile_cells.h"
#include "souple/solver/kernels/compile_links.h"
#include "souple/solver/kernels/compile_motion.h"
#include "souple/solver/kernels/compile_triangles.h"

namespace souple::kernels {

template struct Compile<simd::Neon, OtherConstraints>;
template const CellKernels& cell_kernels<simd::Neon>();
template const LinkKernels& link_kernels<simd::Neon>();
template const MotionKernels& motion_kernels<simd::Neon>();
template const TriangleKernels& triangle_kernels<simd::Neon>();

}  // namespace souple::kernels

#endif
