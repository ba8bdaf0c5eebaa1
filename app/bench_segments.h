#pragma once

#include "souple/collision/segment_triangle/choice.h"
#include "souple/scene/json.h"

#include <string>
#include <vector>

// `souple bench segments`: one segment against many triangles, by each of the tests.

namespace souple::app {

inline constexpr const char* segments_name = "segments";
inline constexpr int default_segments_size = 512;  // all of it in the first-level cache

/// Triangles one behind the other, and segments that pass through all of their boxes and none of them: who
/// has a hierarchy of boxes has to test every triangle too. One triangle is half of a square.
struct SegmentStack {
  std::vector<float> corner[3][3];
  std::vector<Segment<float>> segments;

  explicit SegmentStack(int triangles);
  TriangleColumns columns() const;
};

struct SegmentRate {
  std::string name;
  double scalar = 0, packed = 0;         ///< tests per second, one thread
  int corner_leaks = 0, edge_leaks = 0;  ///< rays that get out of a closed mesh
};

/// From within a ball to each of its corners, and to the middle of each of its edges.
inline constexpr int corner_rays = 642, edge_rays = 1920;

/// The fastest of `runs` tries of each.
std::vector<SegmentRate> measure_segments(const SegmentStack& stack, int runs);

/// Of what has the same name in every result of `souple bench`, and the rates.
scene_format::Json segments_json(int size, const std::vector<SegmentRate>& rates);
void print_segments(const scene_format::Json& result);

}  // namespace souple::app
