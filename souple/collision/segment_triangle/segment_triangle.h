#pragma once

#include "souple/math/vec3.h"

#include <limits>
#include <utility>

// Crossing of a segment and a triangle: the types that all tests share. The default, watertight.h, lies beside it, the
// others in studies/segment_triangle/.
//
// A test is a struct `Test` with
//
//   template <class T, class Function> static auto prepare(const Segment<ScalarOf<T>>&, const Function& f);
//
// prepare computes the part that does not depend on the triangle, and calls f(crosses); crosses(Corners<T>)
// returns the Crossing<T>. T is float, double or a SIMD pack: one segment against as many triangles as a pack
// has lanes.
//
// In the formulas, o + t d is the segment; a, b, c are the corners minus o; e = b - a, f = c - a. The triangle's normal
// is n = e x f, whose length is twice the area.
//
// The segment includes its ends, and the triangle its edges and corners. These cases never cross: a segment parallel to
// the triangle, even within it; a zero length or a zero area; numbers that are not finite. Products of three lengths
// must be in the type's range: with float, lengths from 1e-10 to 1e10 m are safe.

namespace souple {

/// The points origin + t direction, 0 <= t <= max_t. With max_t infinite it is a ray.
template <class T>
struct Segment {
  Vec3<T> origin;     ///< m
  Vec3<T> direction;  ///< m; need not be a unit vector
  T max_t = T(1);
};

/// The segment from a to b.
template <class T>
Segment<T> segment_between(const Vec3<T>& a, const Vec3<T>& b) {
  return {a, b - a};
}

/// Corners of a triangle [m], counter-clockwise as seen from its front.
template <class T>
struct Corners {
  Vec3<T> a, b, c;
};

template <class T>
struct Crossing {
  T t;             ///< parameter along the segment, in [0, max_t]; infinity where it does not cross
  Vec3<T> weight;  ///< barycentric coordinates of the point for a, b and c, >= 0 to rounding, their sum 1
  T side;          ///< 1 where the segment comes from the front, -1 from behind, 0 where it does not cross
};

namespace detail {

template <class T>
struct LaneType {
  using type = T;
};
template <class T>
requires requires {
  typename T::Vector;
}  // a pack
struct LaneType<T> {
  using type = float;
};

}  // namespace detail

/// The type of one lane of T.
template <class T>
using ScalarOf = typename detail::LaneType<T>::type;

/// Copies a segment to every lane.
template <class T>
Segment<T> broadcast(const Segment<ScalarOf<T>>& segment) {
  return {Vec3<T>(segment.origin), Vec3<T>(segment.direction), T(segment.max_t)};
}

/// The crossing of one segment and one triangle, or a pack of triangles.
template <class Test, class T>
Crossing<T> find_crossing(const Segment<ScalarOf<T>>& segment, const Corners<T>& corners) {
  return Test::template prepare<T>(segment, [&](const auto& crosses) { return crosses(corners); });
}

/// A test that was chosen by name.
struct CrossingTest {
  Crossing<float> (*in_float)(const Segment<float>&, const Corners<float>&);
  Crossing<double> (*in_double)(const Segment<double>&, const Corners<double>&);
};
template <class Test>
inline constexpr CrossingTest crossing_test{find_crossing<Test, float>, find_crossing<Test, double>};

namespace detail {

/// `inside`: the segment's line crosses the triangle. `towards_front`: a number with the sign of d . n.
template <class T, class Mask>
Crossing<T> crossing(Mask inside, T t, const Vec3<T>& weight, T towards_front, T max_t) {
  const auto hit = inside && t >= T(0) && t <= max_t;
  const T zero(0);
  constexpr ScalarOf<T> never = std::numeric_limits<ScalarOf<T>>::infinity();
  return {select(hit, t, T(never)),
          {select(hit, weight.x, zero), select(hit, weight.y, zero), select(hit, weight.z, zero)},
          select(hit, select(towards_front > zero, T(-1), T(1)), zero)};
}

/// The crossing from `volume` and `height`, proportional to the weights and to t: weight = volume / sum,
/// t = height / sum. Inside where no volume has the opposite sign of their sum.
template <class T>
Crossing<T> crossing_of_volumes(const Vec3<T>& volume, T sum, T height, T towards_front, T max_t) {
  const T zero(0);
  const T sign = select(sum < zero, T(-1), T(1));
  const auto crosses = abs(sum) > zero;
  const auto inside =
      crosses && volume.x * sign >= zero && volume.y * sign >= zero && volume.z * sign >= zero;
  const T inverse = T(1) / select(crosses, sum, T(1));
  return crossing(inside, height / select(crosses, sum, T(1)), volume * inverse, towards_front, max_t);
}

/// Projects a triangle to two coordinates. It drops the coordinate in which the normal is largest, so that
/// the projection shrinks the triangle least. The order of the others gives areas the sign of that component.
template <class T>
class LargestProjection {
 public:
  explicit LargestProjection(const Vec3<T>& normal)
      : x_(abs(normal.x) >= abs(normal.y) && abs(normal.x) >= abs(normal.z)),
        y_(abs(normal.y) >= abs(normal.z)),
        twice_area_(select(x_, normal.x, select(y_, normal.y, normal.z))) {}

  /// Twice the signed area of the projected triangle: the largest component of its normal.
  T twice_area() const { return twice_area_; }
  /// Signed area of the projected parallelogram of v and w.
  T area(const Vec3<T>& v, const Vec3<T>& w) const { return first(v) * second(w) - second(v) * first(w); }

 private:
  using Mask = decltype(std::declval<T>() < std::declval<T>());
  T first(const Vec3<T>& v) const { return select(x_, v.y, select(y_, v.z, v.x)); }
  T second(const Vec3<T>& v) const { return select(x_, v.z, select(y_, v.x, v.y)); }

  Mask x_, y_;
  T twice_area_;
};

}  // namespace detail
}  // namespace souple
