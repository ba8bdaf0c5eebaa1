#pragma once

#include "souple/collision/segment_triangle/all.h"
#include "souple/collision/segment_triangle/choice.h"

#include <cstddef>
#include <type_traits>

// One segment against many triangles, a register at a time.

namespace souple::kernels {

/// Tests as many triangles, from the first one on, as fill whole registers. Returns the index after the last
/// tested one.
using FindCrossings = std::size_t (*)(const Segment<float>&, const TriangleColumns&, const CrossingColumns&);

struct SegmentKernels {
  FindCrossings plane_projection, signed_volumes, inclusion, moeller_trumbore, watertight;

  template <class Test>
  FindCrossings find() const {
    if constexpr (std::is_same_v<Test, PlaneProjection>) return plane_projection;
    if constexpr (std::is_same_v<Test, SignedVolumes>) return signed_volumes;
    if constexpr (std::is_same_v<Test, Inclusion>) return inclusion;
    if constexpr (std::is_same_v<Test, MoellerTrumbore>) return moeller_trumbore;
    if constexpr (std::is_same_v<Test, Watertight>) return watertight;
  }
};

/// Compiled in one translation unit per instruction set (compile_segments.h).
template <class Isa>
const SegmentKernels& segment_kernels();

}  // namespace souple::kernels
