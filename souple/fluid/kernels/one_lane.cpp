#include "souple/fluid/kernels/compile_neighbors.h"

namespace souple::kernels {

template <>
std::uint32_t near_point<OneLane>(const PointColumns& points, std::uint32_t i, const IndexRange* ranges,
                                  std::size_t range_count, float radius_squared, std::uint32_t* found) {
  const float *x = points.component[0], *y = points.component[1], *z = points.component[2];
  std::uint32_t count = 0;
  for (std::size_t r = 0; r < range_count; ++r) {
    for (std::uint32_t k = ranges[r].begin; k < ranges[r].end; ++k) {
      const float dx = x[k] - x[i], dy = y[k] - y[i], dz = z[k] - z[i];
      if (dx * dx + dy * dy + dz * dz < radius_squared && k != i) found[count++] = 4 * k;
    }
  }
  return count;
}

template const NeighborKernels& neighbor_kernels<OneLane>();

}  // namespace souple::kernels
