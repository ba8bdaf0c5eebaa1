#pragma once

#include "souple/collision/segment_triangle/segment_triangle.h"

#include <cstddef>
#include <utility>

// The tests by name, and many triangles at once. What each is good for: docs/segment-triangle.md.

namespace souple {

enum class InstructionSet;

enum class SegmentTest { plane_projection, signed_volumes, inclusion, moeller_trumbore, watertight };

/// The default: the only one that lets nothing through. docs/segment-triangle.md has what it costs.
inline constexpr SegmentTest default_segment_test = SegmentTest::watertight;

/// The one list of what they are called.
inline constexpr std::pair<const char*, SegmentTest> segment_test_names[] = {
    {"plane_projection", SegmentTest::plane_projection},
    {"signed_volumes", SegmentTest::signed_volumes},
    {"inclusion", SegmentTest::inclusion},
    {"moeller_trumbore", SegmentTest::moeller_trumbore},
    {"watertight", SegmentTest::watertight}};

/// Where the segment crosses the triangle, by the test of that name.
Crossing<float> find_crossing(SegmentTest test, const Segment<float>& segment, const Corners<float>& corners);
Crossing<double> find_crossing(SegmentTest test, const Segment<double>& segment,
                               const Corners<double>& corners);

/// Corners of many triangles: corner[k][j] has component j of corner k of each.
struct TriangleColumns {
  const float* corner[3][3] = {};
  std::size_t count = 0;
};

/// As many crossings as there are triangles.
struct CrossingColumns {
  float* t = nullptr;
  float* weight[3] = {};
  float* side = nullptr;
};

/// find_crossing of the segment and every triangle, a register's worth at a time. The same bits with every
/// instruction set.
void find_crossings(SegmentTest test, const Segment<float>& segment, const TriangleColumns& triangles,
                    const CrossingColumns& crossings);
void find_crossings(SegmentTest test, const Segment<float>& segment, const TriangleColumns& triangles,
                    const CrossingColumns& crossings, InstructionSet set);

}  // namespace souple
