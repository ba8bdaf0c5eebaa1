#pragma once

#include "souple/collision/segment_triangle/segment_triangle.h"

namespace souple {

/// Base of a test that computes nothing of the segment alone: Test::crossing(segment, corners).
template <class Test>
struct PreparedByCopy {
  template <class T, class Function>
  static auto prepare(const Segment<ScalarOf<T>>& segment, const Function& f) {
    return f(
        [copy = broadcast<T>(segment)](const Corners<T>& corners) { return Test::crossing(copy, corners); });
  }
};

}  // namespace souple
