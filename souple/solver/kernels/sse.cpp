#include "souple/solver/kernels/compile.h"
#include "souple/solver/kernels/compile_cells.h"
#include "souple/solver/kernels/compile_links.h"
#include "souple/solver/kernels/compile_motion.h"
#include "souple/solver/kernels/compile_triangles.h"

namespace souple::kernels {

template struct Compile<simd::Sse, OtherConstraints>;
template const CellKernels& cell_kernels<simd::Sse>();
template const LinkKernels& link_kernels<simd::Sse>();
template const MotionKernels& motion_kernels<simd::Sse>();
template const TriangleKernels& triangle_kernels<simd::Sse>();

}  // namespace souple::kernels
