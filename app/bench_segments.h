#pragma once

#include "souple/scene/json.h"
#include "souple/studies/segment_triangle/choice.h"

#include <string>
#include <vector>

// `souple bench segments`: one segment against many triangles, with each of the segment tests.

namespace souple::app {

inline constexpr const char* segments_name = "segments";
inline constexpr int default_segments_size = 512;  // fits into the first-level cache

/// Triangles one behind the other, and segments that pass through the bounding boxes of all triangles but hit
/// none. Even a bounding volume hierarchy has to test every triangle. Each triangle is half of a square.
struct SegmentStack {
  std::vector<float> corner[3][3];
  std::vector<Segment<float>> segments;

  explicit SegmentStack(int triangles);
  TriangleColumns columns() const;
};

struct SegmentRate {
  std::string name;
  double scalar = 0, packed = 0;         ///< tests per second, one thread
  int corner_leaks = 0, edge_leaks = 0;  ///< rays that leave a closed mesh without a hit
};

/// Rays from inside a ball: to each of its corners, and to the midpoint of each of its edges.
inline constexpr int corner_rays = 642, edge_rays = 1920;

/// Rates of the fastest of `runs` tries of each test.
std::vector<SegmentRate> measure_segments(const SegmentStack& stack, int runs);

/// The entries common to all results of `souple bench`, and the rates.
scene_format::Json segments_json(int size, const std::vector<SegmentRate>& rates);
void print_segments(const scene_format::Json& result);

}  // namespace souple::app
