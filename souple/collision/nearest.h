#pragma once

#include "souple/math/vec3.h"

// Nearest points without branches, for T = float, double or simd::Pack<Isa>. Each lane of a pack has the bits
// that float gives.
//
// Every candidate lies on the triangle or on the edges, and the nearest one is the result. Candidates are
// compared by their distances, not by the signs that place a point in a region (Ericson, Real-Time Collision
// Detection, 2005, section 5.1.5). These signs are noise for slivers and for nearly parallel edges, and a
// wrong region gives a point that is far away. So the error of the distance is a few rounding errors of the
// coordinates' size, for any shape. The error of the point is the square root of that where the distance is
// flat.
//
// Pass coordinates relative to a nearby point. Sizes from 1e-9 to 1e9 neither overflow nor underflow in
// float.

namespace souple {

/// Parameter s in [0, 1] of the point a + s (b - a) nearest to p; 0 on an edge of zero length.
template <class T>
T nearest_on_edge(const Vec3<T>& p, const Vec3<T>& a, const Vec3<T>& b) {
  const Vec3<T> ab = b - a;
  const T squared = dot(ab, ab);
  const T s = dot(p - a, ab) / select(squared > T(0), squared, T(1));
  return min(max(s, T(0)), T(1));
}

/// Barycentric weights of the point of triangle a, b, c nearest to p, all >= 0 with the sum 1 to rounding.
///
/// Inside: with n = (b - a) x (c - a), weight a is n . ((b - p) x (c - p)) / |n|^2, and cyclically for b and
/// c. This candidate counts if all three are >= 0; else the nearest point is on an edge.
template <class T>
void nearest_on_triangle(const Vec3<T>& p, const Vec3<T>& a, const Vec3<T>& b, const Vec3<T>& c,
                         T (&weight)[3]) {
  const T zero(0), one(1);
  const Vec3<T> pa = a - p, pb = b - p, pc = c - p;
  const T s_ab = nearest_on_edge(p, a, b), s_bc = nearest_on_edge(p, b, c), s_ca = nearest_on_edge(p, c, a);

  T nearest = length_squared(pa * (one - s_ab) + pb * s_ab);
  weight[0] = one - s_ab;
  weight[1] = s_ab;
  weight[2] = zero;
  const auto consider = [&](T squared, T wa, T wb, T wc) {
    const auto better = squared < nearest;
    nearest = select(better, squared, nearest);
    weight[0] = select(better, wa, weight[0]);
    weight[1] = select(better, wb, weight[1]);
    weight[2] = select(better, wc, weight[2]);
  };
  consider(length_squared(pb * (one - s_bc) + pc * s_bc), zero, one - s_bc, s_bc);
  consider(length_squared(pc * (one - s_ca) + pa * s_ca), s_ca, zero, one - s_ca);

  const Vec3<T> n = cross(b - a, c - a);
  const T va = dot(n, cross(pb, pc)), vb = dot(n, cross(pc, pa)), vc = dot(n, cross(pa, pb));
  const T sum = va + vb + vc;
  const T divisor = select(sum > zero, sum, one);
  const T wa = va / divisor, wb = vb / divisor, wc = vc / divisor;
  const auto inside = va >= zero && vb >= zero && vc >= zero && sum > zero;
  const T squared = length_squared(pa * wa + pb * wb + pc * wc);
  consider(select(inside, squared, nearest), wa, wb, wc);
}

/// Parameters s and t in [0, 1] of the nearest points p0 + s (p1 - p0) and q0 + t (q1 - q0) of two edges. For
/// parallel edges the result is one of the nearest pairs; for edges of zero length s or t is 0.
///
/// With d = p1 - p0, e = q1 - q0, n = d x e, r = q0 - p0, the lines are nearest at s = (r x e) . n / |n|^2.
/// This s is clamped to [0, 1], then projected onto q and from there back onto p (Ericson, section 5.1.9,
/// projects back only if t was clamped). For edges at a small angle a, s has an error of eps / a. The
/// distance changes by a times that, so it is right for any angle, and the ends need not be tested.
template <class T>
void nearest_on_edges(const Vec3<T>& p0, const Vec3<T>& p1, const Vec3<T>& q0, const Vec3<T>& q1, T& s,
                      T& t) {
  const T zero(0), one(1);
  const Vec3<T> d = p1 - p0, e = q1 - q0, n = cross(d, e);
  const T squared = dot(n, n);
  const T within = dot(cross(q0 - p0, e), n) / select(squared > zero, squared, one);
  t = nearest_on_edge(p0 + d * min(max(within, zero), one), q0, q1);
  s = nearest_on_edge(q0 + e * t, p0, p1);
}

}  // namespace souple
