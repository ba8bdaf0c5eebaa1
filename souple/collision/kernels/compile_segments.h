#pragma once

#include "souple/collision/kernels/segments.h"
#include "souple/simd/pack.h"

// Include this only in translation units that are compiled for one instruction set. Every template here has
// the tag of its instruction set as an argument.

namespace souple::kernels {

template <class Isa>
inline Vec3<simd::Pack<Isa>> load_corner(const TriangleColumns& triangles, int k, std::size_t i) {
  using T = simd::Pack<Isa>;
  return {T::load(triangles.corner[k][0] + i), T::load(triangles.corner[k][1] + i),
          T::load(triangles.corner[k][2] + i)};
}

template <class Isa>
inline void store_crossing(const Crossing<simd::Pack<Isa>>& found, const CrossingColumns& out,
                           std::size_t i) {
  found.t.store(out.t + i);
  found.weight.x.store(out.weight[0] + i);
  found.weight.y.store(out.weight[1] + i);
  found.weight.z.store(out.weight[2] + i);
  found.side.store(out.side + i);
}

template <class Isa, class Prepared>
[[gnu::flatten]] std::size_t cross_packs(const Prepared& crosses_segment, const TriangleColumns& columns,
                                         const CrossingColumns& out_columns) {
  // Local copies: the compiler can see that no store changes them.
  const Prepared crosses = crosses_segment;
  const TriangleColumns triangles = columns;
  const CrossingColumns out = out_columns;
  std::size_t i = 0;
  for (; i + Isa::lanes <= triangles.count; i += Isa::lanes) {
    const Corners<simd::Pack<Isa>> corners{load_corner<Isa>(triangles, 0, i),
                                           load_corner<Isa>(triangles, 1, i),
                                           load_corner<Isa>(triangles, 2, i)};
    store_crossing<Isa>(crosses(corners), out, i);
  }
  return i;
}

template <class Isa, class Test>
std::size_t cross_all(const Segment<float>& segment, const TriangleColumns& triangles,
                      const CrossingColumns& out) {
  return Test::template prepare<simd::Pack<Isa>>(
      segment, [&](const auto& crosses) { return cross_packs<Isa>(crosses, triangles, out); });
}

template <class Isa>
const SegmentKernels& segment_kernels() {
  static constexpr SegmentKernels kernels{cross_all<Isa, PlaneProjection>, cross_all<Isa, SignedVolumes>,
                                          cross_all<Isa, Inclusion>, cross_all<Isa, MoellerTrumbore>,
                                          cross_all<Isa, Watertight>};
  return kernels;
}

}  // namespace souple::kernels
