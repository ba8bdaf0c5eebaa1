#pragma once

#include <cstddef>
#include <cstdint>

// Distance tests between points, one register at a time, compiled once per instruction set.

namespace souple::kernels {

/// Sorted indices [begin, end).
struct IndexRange {
  std::uint32_t begin, end;
};

/// Coordinates by component, readable for 16 floats beyond the last.
struct PointColumns {
  const float* component[3];
};

struct NeighborKernels {
  /// Finds the points of the ranges closer to point i than the square root of `radius_squared`, without i
  /// itself. Writes four times their sorted index (the offset of their record of four floats) to `found`, in
  /// order. Returns their count; `found` needs a capacity of 16 more than all candidates.
  std::uint32_t (*near_point)(const PointColumns& points, std::uint32_t i, const IndexRange* ranges,
                              std::size_t range_count, float radius_squared, std::uint32_t* found);
};

template <class Isa>
const NeighborKernels& neighbor_kernels();

}  // namespace souple::kernels
