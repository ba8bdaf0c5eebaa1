#pragma once

#include "souple/collision/detection.h"
#include "souple/collision/segment_triangle/segment_triangle.h"

#include <cstddef>

// Segment-triangle tests by name, for one triangle or many. docs/segment-triangle.md compares them.

namespace souple {

enum class InstructionSet;

/// Crossing of the segment and the triangle, by the given test.
Crossing<float> find_crossing(SegmentTest test, const Segment<float>& segment, const Corners<float>& corners);
Crossing<double> find_crossing(SegmentTest test, const Segment<double>& segment,
                               const Corners<double>& corners);

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

/// find_crossing of the segment with every triangle, as many at a time as a register has lanes. Gives equal bits with
/// every instruction set.
void find_crossings(SegmentTest test, const Segment<float>& segment, const TriangleColumns& triangles,
                    const CrossingColumns& crossings);
void find_crossings(SegmentTest test, const Segment<float>& segment, const TriangleColumns& triangles,
                    const CrossingColumns& crossings, InstructionSet set);

}  // namespace souple
