#if defined(__aarch64__)

#include "souple/collision/kernels/compile_features.h"
#include "souple/collision/kernels/compile_segments.h"

template const souple::kernels::FeatureKernels& souple::kernels::feature_kernels<souple::simd::Neon>();
template const souple::kernels::SegmentKernels& souple::kernels::segment_kernels<souple::simd::Neon>();

#endif
