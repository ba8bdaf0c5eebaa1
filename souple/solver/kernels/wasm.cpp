#if defined(__wasm_simd128__)

#include "souple/solver/kernels/compile.h"
#include "souple/solver/kernels/compile_cells.h"
#include "souple/solver/kernels/compile_links.h"
#include "souple/solver/kernels/compile_motion.h"
#include "souple/solver/kernels/compile_triangles.h"

namespace souple::kernels {

template struct Compile<simd::Wasm, OtherConstraints>;
template const CellKernels& cell_kernels<simd::Wasm>();
template const LinkKernels& link_kernels<simd::Wasm>();
template const MotionKernels& motion_kernels<simd::Wasm>();
template const TriangleKernels& triangle_kernels<simd::Wasm>();

}  // namespace souple::kernels

#endif
