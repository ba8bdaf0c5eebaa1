#pragma once

#include "souple/broad_phase/kernels/patch_kernels.h"
#include "souple/simd/instruction_sets.h"

// Include this only in translation units that are compiled for one instruction set. Every template here has
// the tag of its instruction set as an argument.

namespace souple::kernels {

/// Comparisons of all lanes at once.
template <class Isa>
struct Lanes {
  static constexpr std::uint32_t count = Isa::lanes;
  using Vector = typename Isa::Vector;
  using Mask = typename Isa::Mask;
  static Vector broadcast(float a) { return Isa::broadcast(a); }
  static Mask at_most(const float* a, Vector b) { return Isa::load(a) <= b; }
  static Mask at_least(const float* a, Vector b) { return Isa::load(a) >= b; }
  static Mask equal(const std::uint32_t* a, std::uint32_t b) {
    Mask loaded;
    __builtin_memcpy(&loaded, a, sizeof loaded);
    return loaded == (Mask{} + static_cast<std::int32_t>(b));
  }
  static Mask has_none(const std::uint32_t* a, std::uint32_t b) {
    Mask loaded;
    __builtin_memcpy(&loaded, a, sizeof loaded);
    return (loaded & (Mask{} + static_cast<std::int32_t>(b))) == Mask{};
  }
  static std::uint32_t bits(Mask mask) { return Isa::bits(mask); }
};

/// A box in every lane.
template <class Isa>
struct BroadcastBox {
  typename Lanes<Isa>::Vector lo[3], hi[3];

  explicit BroadcastBox(const float (&box)[6]) {
    for (int axis = 0; axis < 3; ++axis) {
      lo[axis] = Lanes<Isa>::broadcast(box[axis]);
      hi[axis] = Lanes<Isa>::broadcast(box[3 + axis]);
    }
  }
  BroadcastBox(const BoxColumns& boxes, std::size_t i) {
    for (int axis = 0; axis < 3; ++axis) {
      lo[axis] = Lanes<Isa>::broadcast(boxes.lo[axis][i]);
      hi[axis] = Lanes<Isa>::broadcast(boxes.hi[axis][i]);
    }
  }
  typename Lanes<Isa>::Mask overlaps(const BoxColumns& boxes, std::size_t i) const {
    using L = Lanes<Isa>;
    return (L::at_most(boxes.lo[0] + i, hi[0]) & L::at_least(boxes.hi[0] + i, lo[0])) &
           (L::at_most(boxes.lo[1] + i, hi[1]) & L::at_least(boxes.hi[1] + i, lo[1])) &
           (L::at_most(boxes.lo[2] + i, hi[2]) & L::at_least(boxes.hi[2] + i, lo[2]));
  }
};

template <class Isa>
std::uint32_t first_bits(std::uint32_t count) {
  return count < 32 ? (1u << count) - 1 : ~0u;
}

/// Bit k: item k of the group overlaps the box.
template <class Isa>
SOUPLE_INLINE inline std::uint32_t items_in(const BoxColumns& items, const BoxGroup& group,
                                            const float (&box)[6]) {
  const BroadcastBox<Isa> broadcast_box(box);
  std::uint32_t bits = 0;
  for (std::uint32_t k = 0; k < group.count; k += Lanes<Isa>::count)
    bits |= Lanes<Isa>::bits(broadcast_box.overlaps(items, group.begin + k)) << k;
  return bits & first_bits<Isa>(group.count);
}

/// Bit k: item k of the group overlaps box i of `from` and shares no particle with it. No branch depends on
/// the result: the processor could not predict it.
template <class Isa, int n, int other_n>
SOUPLE_INLINE inline std::uint32_t near_one(const BoxColumns& from, std::size_t i, const BoxColumns& items,
                                            const BoxGroup& group) {
  using L = Lanes<Isa>;
  const BroadcastBox<Isa> box(from, i);
  std::uint32_t bits = 0;
  for (std::uint32_t k = 0; k < group.count; k += L::count) {
    const std::size_t at = group.begin + k;
    auto shared = L::equal(items.particle[0] + at, from.particle[0][i]);
    for (int b = 1; b < other_n; ++b) shared |= L::equal(items.particle[b] + at, from.particle[0][i]);
    for (int a = 1; a < n; ++a)
      for (int b = 0; b < other_n; ++b) shared |= L::equal(items.particle[b] + at, from.particle[a][i]);
    bits |= L::bits(box.overlaps(items, at) & ~shared) << k;
  }
  return bits & first_bits<Isa>(group.count);
}

/// Items of the first group that may have a pair with a marked item.
inline std::uint32_t may_have_marked(const BoxGroup& first, const BoxGroup& second) {
  return second.marked != 0 ? ~0u : first.marked;
}
/// Items of the second group whose pair with item k of the first group has a marked item.
inline std::uint32_t wanted_by(const BoxGroup& first, std::uint32_t k, const BoxGroup& second) {
  return (first.marked >> k & 1) != 0 ? ~0u : second.marked;
}

/// Near items of each item of a group, without items that have none. One loop then visits all pairs. A loop
/// per item would end that many times, each time at an iteration that the processor cannot predict.
template <class Isa>
struct Rows {
  std::uint32_t item[BoxGroup::max_items + 1], near[BoxGroup::max_items + 1];
  std::uint32_t count = 0, pairs = 0;

  void add(std::uint32_t which, std::uint32_t bits) {
    item[count] = which;
    near[count] = bits;
    count += bits != 0 ? 1 : 0;
    pairs += bits_of(bits);
  }
  static std::uint32_t bits_of(std::uint32_t x) {
    x -= x >> 1 & 0x55555555u;
    x = (x & 0x33333333u) + (x >> 2 & 0x33333333u);
    return ((x + (x >> 4)) & 0x0f0f0f0fu) * 0x01010101u >> 24;
  }
  /// Calls f(item, bit) for each pair.
  template <class Function>
  SOUPLE_INLINE void for_each(const Function& f) {
    near[count] = item[count] = 0;
    std::uint32_t row = 0, left = near[0];
    for (std::uint32_t p = 0; p < pairs; ++p) {
      f(item[row], static_cast<std::uint32_t>(__builtin_ctz(left)));
      left &= left - 1;
      row += left == 0 ? 1 : 0;
      left = left == 0 ? near[row] : left;
    }
  }
};

/// Vertices against triangles (3 corners) or edges (2).
template <class Isa, int corners>
std::size_t vertices_items(const BoxColumns& vertices, const BoxGroup& v, const BoxColumns& items,
                           const BoxGroup& group, Quad* pairs) {
  constexpr int first = 4 - corners;
  Rows<Isa> rows;
  for (std::uint32_t near = items_in<Isa>(vertices, v, group.box) & may_have_marked(v, group); near != 0;
       near &= near - 1) {
    const auto k = static_cast<std::uint32_t>(__builtin_ctz(near));
    rows.add(v.begin + k,
             near_one<Isa, 1, corners>(vertices, v.begin + k, items, group) & wanted_by(v, k, group));
  }
  Quad* next = pairs;
  rows.for_each([&](std::uint32_t i, std::uint32_t bit) {
    Quad& pair = *next++;
    for (int k = 0; k < first; ++k) pair[k] = vertices.particle[0][i];
    for (int k = 0; k < corners; ++k) pair[first + k] = items.particle[k][group.begin + bit];
  });
  return rows.pairs;
}

// Starting from the group with fewer edges costs more, for finding them, than it saves (5 %).
template <class Isa>
std::size_t edges_edges(const BoxColumns& edges, const BoxGroup& a, const BoxGroup& b, Quad* pairs) {
  Rows<Isa> rows;
  const bool same = a.begin == b.begin;
  for (std::uint32_t near = items_in<Isa>(edges, a, b.box) & may_have_marked(a, b); near != 0;
       near &= near - 1) {
    const auto k = static_cast<std::uint32_t>(__builtin_ctz(near));
    const std::uint32_t overlaps = near_one<Isa, 2, 2>(edges, a.begin + k, edges, b) & wanted_by(a, k, b);
    rows.add(a.begin + k, same ? overlaps & ~first_bits<Isa>(k + 1) : overlaps);
  }
  Quad* next = pairs;
  rows.for_each([&](std::uint32_t i, std::uint32_t bit) {
    Quad& pair = *next++;
    for (int e = 0; e < 2; ++e) {
      pair[e] = edges.particle[e][i];
      pair[2 + e] = edges.particle[e][b.begin + bit];
    }
  });
  return rows.pairs;
}

template <class Isa>
std::size_t overlapping(const BoxColumns& boxes, std::size_t begin, std::size_t count, const float (&box)[6],
                        const std::uint32_t* keys, std::uint32_t mask, std::uint32_t* found) {
  using L = Lanes<Isa>;
  const BroadcastBox<Isa> broadcast_box(box);
  std::size_t n = 0;
  for (std::size_t k = 0; k < count; k += L::count) {
    std::uint32_t overlaps =
        L::bits(broadcast_box.overlaps(boxes, begin + k) & L::has_none(keys + begin + k, mask));
    if (count - k < L::count) overlaps &= first_bits<Isa>(static_cast<std::uint32_t>(count - k));
    for (; overlaps != 0; overlaps &= overlaps - 1)
      found[n++] = keys[begin + k + static_cast<std::uint32_t>(__builtin_ctz(overlaps))];
  }
  return n;
}

template <class Isa>
const PatchKernels& patch_kernels() {
  static constexpr PatchKernels kernels{vertices_items<Isa, 3>, vertices_items<Isa, 2>, edges_edges<Isa>,
                                        overlapping<Isa>};
  return kernels;
}

}  // namespace souple::kernels
