#include "souple/collision/kernels/single.h"

#include "souple/collision/kernels/compile_features.h"

template const souple::kernels::FeatureKernels& souple::kernels::feature_kernels<souple::kernels::Single>();
