#pragma once

#include "souple/collision/detection.h"
#include "souple/collision/segment_triangle/segment_triangle.h"

#include <cstddef>

// Segment-triangle tests by name, for one triangle or many. docs/segment-triangle.md compares them.

namespace souple {

const CrossingTest& crossing_test_of(SegmentTest test);

/// Corners of many triangles: corner[k][j] is the column of component j of corner k [m].
struct TriangleColumns {
  const float* corner[3][3] = {};
  std::size_t count = 0;
};

/// Output columns: one crossing per triangle.
struct CrossingColumns {
  float* t = nullptr;
  float* weight[3] = {};
  float* side = nullptr;
};

/// The crossings of the segment with every triangle, one by one, or as many at a time as a register has lanes, with
/// equal bits. The register is that of the architecture's plainest instruction set.
void find_crossings(SegmentTest test, const Segment<float>& segment, const TriangleColumns& triangles,
                    const CrossingColumns& crossings, bool packed = true);

}  // namespace souple
