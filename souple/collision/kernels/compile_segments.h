#pragma once

#include "souple/collision/kernels/segments.h"
#include "souple/math/simd/pack.h"

// Included by the translation units that are compiled for one instruction set, and by nothing else; every
// template here carries the set's tag.

namespace souple::kernels {

template <class Set>
inline Vec3<simd::Pack<Set>> load_corner(const TriangleColumns& triangles, int k, std::size_t i) {
  using T = simd::Pack<Set>;
  return {T::load(triangles.corner[k][0] + i), T::load(triangles.corner[k][1] + i),
          T::load(triangles.corner[k][2] + i)};
}

template <class Set>
inline void store_crossing(const Crossing<simd::Pack<Set>>& found, const CrossingColumns& out,
                           std::size_t i) {
  found.t.store(out.t + i);
  found.weight.x.store(out.weight[0] + i);
  found.weight.y.store(out.weight[1] + i);
  found.weight.z.store(out.weight[2] + i);
  found.side.store(out.side + i);
}

template <class Set, class Prepared>
[[gnu::flatten]] std::size_t cross_packs(const Prepared& crosses_segment, const TriangleColumns& columns,
                                         const CrossingColumns& out_columns) {
  // Copies that the compiler knows no store to change.
  const Prepared crosses = crosses_segment;
  const TriangleColumns triangles = columns;
  const CrossingColumns out = out_columns;
  std::size_t i = 0;
  for (; i + Set::lanes <= triangles.count; i += Set::lanes) {
    const Corners<simd::Pack<Set>> corners{load_corner<Set>(triangles, 0, i),
                                           load_corner<Set>(triangles, 1, i),
                                           load_corner<Set>(triangles, 2, i)};
    store_crossing<Set>(crosses(corners), out, i);
  }
  return i;
}

template <class Set, class Test>
std::size_t cross_all(const Segment<float>& segment, const TriangleColumns& triangles,
                      const CrossingColumns& out) {
  return Test::template prepare<simd::Pack<Set>>(
      segment, [&](const auto& crosses) { return cross_packs<Set>(crosses, triangles, out); });
}

template <class Set>
const SegmentKernels& segment_kernels() {
  static constexpr SegmentKernels kernels{cross_all<Set, PlaneProjection>, cross_all<Set, SignedVolumes>,
                                          cross_all<Set, Inclusion>, cross_all<Set, MoellerTrumbore>,
                                          cross_all<Set, Watertight>};
  return kernels;
}

}  // namespace souple::kernels
