#pragma once

#include <cstddef>
#include <cstdint>

// Boxes against boxes, a register's worth at a time: compiled once for each instruction set.

namespace souple::kernels {

/// Boxes and the particles of what they surround, component by component: box i is lo[0][i] to hi[0][i] along
/// x and so on. Readable for most_items beyond the last. Those that overlap nothing have lo above hi.
struct BoxColumns {
  const float* lo[3];
  const float* hi[3];
  const std::uint32_t* particle[3];  ///< as many as there are corners
};

/// The items that belong together: [begin, begin + count), at most most_items, and a box around them: lo, hi.
struct BoxGroup {
  static constexpr std::uint32_t max_items = 32;
  std::uint32_t begin, count;
  float box[6];
  std::uint32_t marked = ~0u;  ///< bit k: item k. Pairs of which neither is marked are left out.
};

/// Four particles: a vertex and a triangle's, or two edges'. A vertex stands as an edge from it to itself.
using Quad = std::uint32_t[4];

struct PatchKernels {
  /// Vertices and triangles whose boxes overlap and that share no particle, by vertex, then triangle. Returns
  /// how many; room for all that there may be is needed, as below.
  std::size_t (*vertices_triangles)(const BoxColumns& vertices, const BoxGroup& v,
                                    const BoxColumns& triangles, const BoxGroup& t, Quad* pairs);
  /// The same of vertices and edges.
  std::size_t (*vertices_edges)(const BoxColumns& vertices, const BoxGroup& v, const BoxColumns& edges,
                                const BoxGroup& e, Quad* pairs);
  /// Edges of two groups; those of one group where a and b begin alike, each pair once.
  std::size_t (*edges_edges)(const BoxColumns& edges, const BoxGroup& a, const BoxGroup& b, Quad* pairs);
  /// Which of `count` items from `begin` on overlap a box: their places in `keys`' order, keys[i] & mask == 0
  /// provided, written to `found`. Returns how many; room for all is needed.
  std::size_t (*overlapping)(const BoxColumns& boxes, std::size_t begin, std::size_t count,
                             const float (&box)[6], const std::uint32_t* keys, std::uint32_t mask,
                             std::uint32_t* found);
};

/// One lane, for processors without registers of ours and to compare with.
struct Scalar {};

template <class Isa>
const PatchKernels& patch_kernels();

}  // namespace souple::kernels
