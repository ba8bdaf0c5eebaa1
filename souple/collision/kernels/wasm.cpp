#if defined(__wasm_simd128__)

#include "souple/collision/kernels/compile_segments.h"

template const souple::kernels::SegmentKernels& souple::kernels::segment_kernels<souple::simd::Wasm>();

#endif
