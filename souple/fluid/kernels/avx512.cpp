#include "souple/fluid/kernels/compile.h"

template const souple::kernels::NeighbourKernels& souple::kernels::neighbour_kernels<souple::simd::Avx512>();
