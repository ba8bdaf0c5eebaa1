#pragma once

#include <utility>

namespace souple {

/// Tests of a segment and a triangle, by name. docs/segment-triangle.md compares them.
enum class SegmentTest { plane_projection, signed_volumes, inclusion, moeller_trumbore, watertight };

/// The default: the only watertight test, which misses no crossing of a closed mesh. docs/segment-triangle.md
/// has its cost.
inline constexpr SegmentTest default_segment_test = SegmentTest::watertight;

/// Names of all tests; the only list of them.
inline constexpr std::pair<const char*, SegmentTest> segment_test_names[] = {
    {"plane_projection", SegmentTest::plane_projection},
    {"signed_volumes", SegmentTest::signed_volumes},
    {"inclusion", SegmentTest::inclusion},
    {"moeller_trumbore", SegmentTest::moeller_trumbore},
    {"watertight", SegmentTest::watertight}};

/// How contacts between surfaces are found in a substep.
enum class Detection {
  /// Vertices against triangles and edges against edges, by distance and by time of impact.
  continuous,
  /// Vertices whose path x -> p crosses a triangle (Müller et al. 2007, section 3.4), by a SegmentTest. It serves for
  /// comparison: edges pass through edges, and a vertex that the test misses passes as well.
  discrete
};

}  // namespace souple
