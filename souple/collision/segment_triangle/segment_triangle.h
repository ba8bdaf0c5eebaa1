#pragma once

#include "souple/math/vec3.h"

#include <limits>
#include <utility>

// Where a segment crosses a triangle: what every test takes and gives. Each test has a file of its own, and
// choice.h a list of them.
//
// A test is a struct `Test` with
//
//   template <class T, class Function> static auto prepare(const Segment<ScalarOf<T>>&, const Function& f);
//
// which calls f(crosses) with what is the same for every triangle; crosses(Corners<T>) is the Crossing<T>.
// T is float, double or a SIMD pack: one segment against as many triangles as a pack has lanes.
//
// In the formulas o + t d is the segment, a, b, c are the corners less o, e = b - a, f = c - a, and
// n = e x f is the triangle's normal, as long as twice its area.
//
// The segment's ends and the triangle's edges and corners belong to them. A segment parallel to a triangle
// does not cross it, not even where it lies in it; nor does a segment of no length, nor anything a triangle
// of no area, nor what is not finite. Products of three lengths have to be numbers of the type: with float,
// lengths from 1e-10 to 1e10 m are safe.

namespace souple {

/// The points origin + t direction, 0 <= t <= reach. A reach of infinity makes it a ray.
template <class T>
struct Segment {
  Vec3<T> origin;     ///< m
  Vec3<T> direction;  ///< m; need not be a unit vector
  T max_t = T(1);
};

/// From a to b.
template <class T>
Segment<T> segment_between(const Vec3<T>& a, const Vec3<T>& b) {
  return {a, b - a};
}

/// A triangle's corners. [m] Its front is where they are seen counter-clockwise.
template <class T>
struct Corners {
  Vec3<T> a, b, c;
};

template <class T>
struct Crossing {
  T t;             ///< along the segment, in [0, reach]; infinity where it does not cross
  Vec3<T> weight;  ///< barycentric coordinates of the point for a, b and c, >= 0 to rounding, their sum 1
  T side;          ///< 1 where it comes from the front, -1 from behind, 0 where it does not cross
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

/// The type of one lane.
template <class T>
using ScalarOf = typename detail::LaneType<T>::type;

/// A segment in every lane.
template <class T>
Segment<T> broadcast(const Segment<ScalarOf<T>>& segment) {
  return {Vec3<T>(segment.origin), Vec3<T>(segment.direction), T(segment.max_t)};
}

/// The crossing of one segment and one triangle, or of one segment and a pack of them.
template <class Test, class T>
Crossing<T> find_crossing(const Segment<ScalarOf<T>>& segment, const Corners<T>& corners) {
  return Test::template prepare<T>(segment, [&](const auto& crosses) { return crosses(corners); });
}

namespace detail {

/// `inside`: the line crosses the triangle; `towards_front`: of the sign of d . n.
template <class T, class Mask>
Crossing<T> crossing(Mask inside, T t, const Vec3<T>& weight, T towards_front, T max_t) {
  const auto hit = inside && t >= T(0) && t <= max_t;
  const T zero(0);
  constexpr ScalarOf<T> never = std::numeric_limits<ScalarOf<T>>::infinity();
  return {select(hit, t, T(never)),
          {select(hit, weight.x, zero), select(hit, weight.y, zero), select(hit, weight.z, zero)},
          select(hit, select(towards_front > zero, T(-1), T(1)), zero)};
}

/// From numbers proportional to the weights, all of the sign of their sum or zero, and to the parameter:
/// weight = volume / sum, t = height / sum.
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

/// The two coordinates of the plane onto which a triangle is projected: the third is the one in which its
/// normal is largest, so that the projection shrinks it least. In the order in which the areas keep the sign
/// of that component.
template <class T>
class LargestProjection {
 public:
  explicit LargestProjection(const Vec3<T>& normal)
      : x_(abs(normal.x) >= abs(normal.y) && abs(normal.x) >= abs(normal.z)),
        y_(abs(normal.y) >= abs(normal.z)),
        twice_area_(select(x_, normal.x, select(y_, normal.y, normal.z))) {}

  /// Of the triangle itself: the largest component of its normal.
  T twice_area() const { return twice_area_; }
  /// Of the parallelogram of v and w.
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
