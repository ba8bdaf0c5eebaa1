#pragma once

#include <utility>

namespace souple {

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

}  // namespace souple
