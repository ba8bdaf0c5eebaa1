#pragma once

#include "souple/studies/segment_triangle/prepared_by_copy.h"

namespace souple {

/// Signed volumes: O'Rourke, Computational Geometry in C, 2nd edition, section 7.3.
///
/// Six times the volumes of the tetrahedra of the segment and each of the triangle's edges,
///
///   U = d . (b x c),   V = d . (c x a),   W = d . (a x b),
///
/// give the side on which the segment's line passes each edge. It crosses the triangle where no volume
/// differs from the others in sign (O'Rourke's SegTriCross). Their sum is d . n, since b x c + c x a + a x b
/// = e x f, so that
///
///   weights = (U, V, W) / (U + V + W),   t = a . n / (U + V + W).
///
/// Deviation: O'Rourke first tests whether both ends are on one side of the plane; here t in [0, max_t] does.
///
/// Volumes are rounded: a line within rounding of a corner may appear to pass outside of all triangles there.
/// At an edge, both triangles compute the same numbers with opposite signs, so they never both miss the line.
struct SignedVolumes : PreparedByCopy<SignedVolumes> {
  template <class T>
  static Crossing<T> crossing(const Segment<T>& segment, const Corners<T>& corners) {
    const Vec3<T>& d = segment.direction;
    const Vec3<T> a = corners.a - segment.origin, b = corners.b - segment.origin,
                  c = corners.c - segment.origin;
    const Vec3<T> volume{dot(d, cross(b, c)), dot(d, cross(c, a)), dot(d, cross(a, b))};
    const T sum = volume.x + volume.y + volume.z;
    const Vec3<T> n = cross(corners.b - corners.a, corners.c - corners.a);
    return detail::crossing_of_volumes(volume, sum, dot(a, n), sum, segment.max_t);
  }
};

}  // namespace souple
