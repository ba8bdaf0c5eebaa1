#if defined(__wasm_simd128__)

#include "souple/solver/kernels/compile.h"

namespace souple::kernels {

template struct Compile<simd::Wasm, MeshConstraints>;

}  // namespace souple::kernels

#endif
