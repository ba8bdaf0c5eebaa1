#pragma once

#include "souple/collision/segment_triangle/segment_test.h"

namespace souple {

/// How contacts between surfaces are found in a substep.
enum class Detection {
  /// Vertices against triangles and edges against edges, by distance and by time of impact.
  continuous,
  /// Vertices whose path x -> p crosses a triangle (Müller et al. 2007, section 3.4), by a SegmentTest. It
  /// serves for comparison: edges pass through edges, and what a test misses passes as well.
  discrete
};

}  // namespace souple
