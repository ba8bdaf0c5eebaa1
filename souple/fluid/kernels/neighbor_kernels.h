#pragma once

#include <cstddef>
#include <cstdint>

// Points against points, a register's worth at a time: compiled once for each instruction set.

namespace souple::kernels {

/// Places [begin, end).
struct IndexRange {
  std::uint32_t begin, end;
};

/// Points component by component, readable for 16 floats beyond the last.
struct PointColumns {
  const float* component[3];
};

struct NeighborKernels {
  /// Which points of the ranges are closer to point i than the square root of `radius_squared`, itself left
  /// out: their places times four (where their record of four floats begins), written to `found` in order.
  /// Returns how many; room for 16 more than all is needed.
  std::uint32_t (*near_point)(const PointColumns& points, std::uint32_t i, const IndexRange* ranges,
                              std::size_t range_count, float radius_squared, std::uint32_t* found);
};

/// One lane, for processors without registers of ours and to compare with.
struct OneLane {};

template <class Isa>
const NeighborKernels& neighbor_kernels();

}  // namespace souple::kernels
