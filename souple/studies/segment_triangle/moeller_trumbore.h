#pragma once

#include "souple/studies/segment_triangle/prepared_by_copy.h"

namespace souple {

/// Möller and Trumbore, Fast, minimum storage ray/triangle intersection, 1997.
///
/// The point is a + v e + w f with v, w and t unknown (their eq. 3); with s = -a, from corner a to the
/// origin,
///
///   [-d, e, f] (t, v, w) = s.
///
/// Cramer's rule, with p = d x f and q = s x e shared between the determinants (eq. 6):
///
///   det = e . p,   v = s . p / det,   w = d . q / det,   t = f . q / det.
///
/// det = -d . n is positive where the segment comes from the front. Deviation: the paper divides first and
/// compares v + w with 1. Here the third weight is compared with 0 before the division, so rounding does not
/// exclude the edge between b and c. But the weight of that edge is a difference of the others, and not the
/// same number in the neighboring triangle.
struct MoellerTrumbore : PreparedByCopy<MoellerTrumbore> {
  template <class T>
  static Crossing<T> crossing(const Segment<T>& segment, const Corners<T>& corners) {
    const Vec3<T>& d = segment.direction;
    const Vec3<T> e = corners.b - corners.a, f = corners.c - corners.a, s = segment.origin - corners.a;
    const Vec3<T> p = cross(d, f), q = cross(s, e);
    const T det = dot(e, p), v = dot(s, p), w = dot(d, q);
    return detail::crossing_of_volumes({det - v - w, v, w}, det, dot(f, q), -det, segment.max_t);
  }
};

}  // namespace souple
