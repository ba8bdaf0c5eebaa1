#include "souple/solver/kernels/compile.h"
#include "souple/solver/kernels/compile_cells.h"
#include "souple/solver/kernels/compile_links.h"
#include "souple/solver/kernels/compile_motion.h"
#include "souple/solver/kernels/compile_triangles.h"

namespace souple::kernels {

template struct Compile<simd::Avx2, OtherConstraints>;
template const CellKernels& cell_kernels<simd::Avx2>();
template const LinkKernels& link_kernels<simd::Avx2>();
template const MotionKernels& motion_kernels<simd::Avx2>();
template const TriangleKernels& triangle_kernels<simd::Avx2>();

}  // namespace souple::kernels
