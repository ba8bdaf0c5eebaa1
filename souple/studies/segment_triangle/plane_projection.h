#pragma once

#include "souple/studies/segment_triangle/prepared_by_copy.h"

namespace souple {

/// Projection of the plane: Badouel, An efficient ray-polygon intersection, Graphics Gems, 1990.
///
/// At the crossing of the segment and the triangle's plane, n . (t d - a) = 0:
///
///   t = a . n / d . n.
///
/// The vector from corner a to that point is g = t d - a = v e + w f. Both sides are projected along the axis
/// in which n is largest; two equations remain for v and w. With [x, y] the area of two projected vectors,
///
///   v = [g, f] / [e, f],   w = [e, g] / [e, f],
///
/// and the point is inside where v >= 0, w >= 0 and v + w <= 1. Deviation: Badouel divides by a coordinate of
/// e and needs a special case where it is zero. Cramer's rule needs none, and [e, f] is that component of n.
///
/// Slivers lose digits twice. The rounded n is not quite perpendicular to the long edges, and far along them the plane
/// is off by more than the sliver's width.
struct PlaneProjection : PreparedByCopy<PlaneProjection> {
  template <class T>
  static Crossing<T> crossing(const Segment<T>& segment, const Corners<T>& corners) {
    const Vec3<T>& d = segment.direction;
    const Vec3<T> e = corners.b - corners.a, f = corners.c - corners.a, a = corners.a - segment.origin;
    const Vec3<T> n = cross(e, f);
    const T approach = dot(d, n);
    const auto crosses_plane = abs(approach) > T(0);
    const T t = dot(a, n) / select(crosses_plane, approach, T(1));

    const Vec3<T> g = d * t - a;
    const detail::LargestProjection<T> projection(n);
    const T inverse = T(1) / select(crosses_plane, projection.twice_area(), T(1));
    const T v = projection.area(g, f) * inverse, w = projection.area(e, g) * inverse;
    const auto inside = crosses_plane && v >= T(0) && w >= T(0) && v + w <= T(1);
    return detail::crossing(inside, t, {T(1) - v - w, v, w}, approach, segment.max_t);
  }
};

}  // namespace souple
