#pragma once

#include "souple/studies/segment_triangle/prepared_by_copy.h"

namespace souple {

/// Inclusion test: Snyder and Barr, Ray tracing complex models containing surface tessellations, SIGGRAPH
/// 1987.
///
/// The line crosses the plane at t = a . n / d . n, g = t d. This point and the corners form three triangles.
/// All are projected along the axis in which n is largest. The weights are the ratios of their areas to that
/// of the whole triangle:
///
///   weight of a = [b - g, c - g] / [e, f],   of b = [c - g, a - g] / [e, f],
///   of c = [a - g, b - g] / [e, f].
///
/// The point is inside where no weight is negative. All corners are treated alike. In Badouel's test and in that of
/// Möller and Trumbore, one weight is a difference of the others. Slivers are as hard as for Badouel's.
struct Inclusion : PreparedByCopy<Inclusion> {
  template <class T>
  static Crossing<T> crossing(const Segment<T>& segment, const Corners<T>& corners) {
    const Vec3<T>& d = segment.direction;
    const Vec3<T> n = cross(corners.b - corners.a, corners.c - corners.a);
    const Vec3<T> a = corners.a - segment.origin;
    const T approach = dot(d, n);
    const auto crosses_plane = abs(approach) > T(0);
    const T t = dot(a, n) / select(crosses_plane, approach, T(1));

    const Vec3<T> g = d * t;
    const Vec3<T> to_a = a - g, to_b = corners.b - segment.origin - g, to_c = corners.c - segment.origin - g;
    const detail::LargestProjection<T> projection(n);
    const T inverse = T(1) / select(crosses_plane, projection.twice_area(), T(1));
    const Vec3<T> weight =
        Vec3<T>{projection.area(to_b, to_c), projection.area(to_c, to_a), projection.area(to_a, to_b)} *
        inverse;
    const auto inside = crosses_plane && weight.x >= T(0) && weight.y >= T(0) && weight.z >= T(0);
    return detail::crossing(inside, t, weight, approach, segment.max_t);
  }
};

}  // namespace souple
