#include "souple/fluid/kernels/compile_density.h"
#include "souple/fluid/kernels/compile_neighbours.h"

template const souple::kernels::NeighbourKernels& souple::kernels::neighbour_kernels<souple::simd::Avx2>();
template const souple::kernels::DensityKernels& souple::kernels::density_kernels<souple::simd::Avx2>();
