#pragma once

#include "souple/contacts/kernels/collider_contacts.h"

// Edges and triangles against one collider, a register of elements at a time. All versions return the same bits.
//
// The point of an element nearest to a convex shape is on an edge, or below the shape's farthest point along the
// element's normal. So the first kernel searches the edges and the second tests the triangles' insides.

namespace souple::kernels {

/// Particles in the frame of a body, one record of four floats each; w = length of the motion.
struct ColliderFrameRecords {
  float* from = nullptr;  ///< position at the substep's start [m]
  float* to = nullptr;    ///< at the end of its predicted motion [m]
};

/// Candidates of one body. An edge's third corner is its second.
struct ColliderElements {
  const std::uint32_t* corner[3] = {};  ///< first float of its record
  const float* radius = nullptr;        ///< r: smallest of its particles [m]
  float clearance_part = 0;             ///< distance that its deepest point keeps, as a part of r
};

/// Per candidate: the deepest point at its first touch, or at the end of its motion.
struct ColliderElementTouches {
  float* touches = nullptr;  ///< 0 or 1; if 0, the others are not set except start_distance
  float* weight[3] = {};     ///< of its corners
  float* start_distance =
      nullptr;            ///< from the surface at the substep's start, at most 2 r off when above r [m]
  float* normal[3] = {};  ///< in the frame
  float* plane_offset = nullptr;  ///< of the surface's tangent plane, in the frame [m]
};

/// Searches in a signed distance field, per candidate.
struct ColliderFieldSearch {
  float* u = nullptr;            ///< weight of the second corner where the last search ended
  float* v = nullptr;            ///< weight of the third corner; edges: 0
  float* lower = nullptr;        ///< lower bound of the distance by the last sampling [m]
  const float* limit = nullptr;  ///< elements that are farther away are not sampled [m]
  int parts = 1;                 ///< number of parts of a side when it is sampled
  float gap = 0;                 ///< no point of an element is farther from a sample [m]
};

struct ColliderElementKernels {
  /// Writes the records of particles rows[begin, end) (4 rows[i]: its first float) from particle[rows[i]].
  void (*place)(const ColliderParticles&, const ColliderBody&, const std::uint32_t* particle,
                const std::uint32_t* rows, std::size_t begin, std::size_t end, const ColliderFrameRecords&);
  /// near[i]: 1 if the edge may be nearer to the surface than its ends, and closer than its radius. Its corners may
  /// move by at most reach[i] meanwhile. Positions: `to`.
  void (*near_edges)(const ColliderBody&, const ColliderFrameRecords&, const ColliderElements&,
                     const float* reach, std::size_t begin, std::size_t end, float* near);
  void (*near_triangles)(const ColliderBody&, const ColliderFrameRecords&, const ColliderElements&,
                         const float* reach, std::size_t begin, std::size_t end, float* near);
  void (*find_edges)(const ColliderBody&, const ColliderFrameRecords&, const ColliderElements&,
                     std::size_t begin, std::size_t end, const ColliderElementTouches&);
  void (*find_triangles)(const ColliderBody&, const ColliderFrameRecords&, const ColliderElements&,
                         std::size_t begin, std::size_t end, const ColliderElementTouches&);
  /// Samples the elements list[begin, end) of a signed distance field: sets u, v and lower.
  void (*sample_field_elements)(const ColliderBody&, const ColliderFrameRecords&, const ColliderElements&,
                                const ColliderFieldSearch&, const std::uint32_t* list, std::size_t begin,
                                std::size_t end);
  /// Searches from u and v on, for list[begin, end).
  void (*find_in_field)(const ColliderBody&, const ColliderFrameRecords&, const ColliderElements&,
                        const ColliderFieldSearch&, const std::uint32_t* list, std::size_t begin,
                        std::size_t end, const ColliderElementTouches&);
};

/// Compiled in one translation unit per instruction set (compile_collider_elements.h).
template <class Isa>
const ColliderElementKernels& collider_element_kernels();

}  // namespace souple::kernels
