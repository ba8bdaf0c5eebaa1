#pragma once

#include "souple/collision/nearest.h"
#include "souple/simd/pack.h"

namespace souple {

// Compiled once for each instruction set. Every name below contains the set, and the code uses nothing
// outside this set: otherwise the linker might replace one set's code by another's. benchmarks/continuous.cpp
// measures it.

template <class Isa>
struct PackedPoints {
  using Pack = simd::Pack<Isa>;
  Vec3<Pack> p[4];
  explicit PackedPoints(const float* x) {
    for (Vec3<Pack>& v : p) {
      v = {Pack::load(x), Pack::load(x + Isa::lanes), Pack::load(x + 2 * Isa::lanes)};
      x += 3 * Isa::lanes;
    }
  }
};

/// nearest_on_triangle of `count` packs of four points; summing each lane prevents the compiler from omitting
/// it.
template <class Isa>
void triangles_of_packs(const float* x, int count, float* sum) {
  simd::Pack<Isa> total(0.0f), weight[3];
  for (int k = 0; k < count; ++k, x += 12 * Isa::lanes) {
    const PackedPoints<Isa> at(x);
    nearest_on_triangle(at.p[0], at.p[1], at.p[2], at.p[3], weight);
    total += weight[0] + weight[1];
  }
  total.store(sum);
}

/// nearest_on_edges of `count` packs of four points.
template <class Isa>
void edges_of_packs(const float* x, int count, float* sum) {
  simd::Pack<Isa> total(0.0f), s, t;
  for (int k = 0; k < count; ++k, x += 12 * Isa::lanes) {
    const PackedPoints<Isa> at(x);
    nearest_on_edges(at.p[0], at.p[1], at.p[2], at.p[3], s, t);
    total += s + t;
  }
  total.store(sum);
}

}  // namespace souple
