#include "souple/collision/continuous.h"

#include "souple/collision/cubic.h"
#include "souple/collision/nearest.h"

#include <initializer_list>
#include <limits>

// Two tests prove that two elements do not touch. Each is sound by itself.
//
// Separation. For any unit vector n, the distance of two convex hulls is at least the minimum over their
// pairs of corners of n . (x_a - x_b). While n is constant and corners move straight, each of these is linear
// in time. So they give the time until which the distance exceeds a bound, exactly and not by a Lipschitz
// constant: motion across n costs nothing. With n along the shortest connection this is conservative
// advancement (Mirtich 1996, section 2.3). Li et al. 2021, "Codimensional IPC", algorithm 1, advance by the length of
// the motion instead. A vertex that slides along a triangle then advances very slowly. Any n is sound, so rounding
// errors of n do not matter.
//
// Volume. With e, f, r as in wedge below and n = e x f, V(t) = r . n is a cubic. |V| / |n| is the distance of the
// particle to the plane, or of the two lines. It is a lower bound of the distance of the elements. Let N(t) >= |n(t)|
// be a quadratic whose Bernstein coefficients are the lengths of those of n. The elements are separated by more than
// `bound` before the first root of |V| - bound N. (Provot 1997 tests V = 0, which leaves no margin for rounding.) If
// the Bernstein coefficients of |V| - bound N are positive there is no root, else cubic.h finds it.
//
// Separation finds straight motion in one step and is slow where elements rotate around each other. Volume
// handles rotation, but gives no bound beside the triangle. So both are tested, and the later time counts.

namespace souple {
namespace {

constexpr double eps = std::numeric_limits<double>::epsilon();

struct Pair {
  int a, b;
};

double largest(const Vec3d& v) {
  return max(max(abs(v.x), abs(v.y)), abs(v.z));
}

struct VertexTriangle {
  static constexpr int first = 1;  // particles [0, first) are one element, the others the second element
  static constexpr Pair pairs[] = {{0, 1}, {0, 2}, {0, 3}};

  /// From the nearest point of the triangle to the particle.
  static Vec3d connection(const Vec3d (&x)[4]) {
    double w[3];
    const Vec3d a = x[1] - x[0], b = x[2] - x[0], c = x[3] - x[0];
    nearest_on_triangle({}, a, b, c, w);
    return -(a * w[0] + b * w[1] + c * w[2]);
  }
  static void wedge(const Vec3d (&x)[4], Vec3d& e, Vec3d& f, Vec3d& r) {
    e = x[2] - x[1];
    f = x[3] - x[1];
    r = x[0] - x[1];
  }
};

struct EdgeEdge {
  static constexpr int first = 2;
  static constexpr Pair pairs[] = {{0, 2}, {0, 3}, {1, 2}, {1, 3}};

  /// From the nearest point of edge 2, 3 to the nearest point of edge 0, 1.
  static Vec3d connection(const Vec3d (&x)[4]) {
    double s = 0, t = 0;
    const Vec3d p1 = x[1] - x[0], q0 = x[2] - x[0], q1 = x[3] - x[0];
    nearest_on_edges({}, p1, q0, q1, s, t);
    return p1 * s - (q0 + (q1 - q0) * t);
  }
  static void wedge(const Vec3d (&x)[4], Vec3d& e, Vec3d& f, Vec3d& r) {
    e = x[1] - x[0];
    f = x[3] - x[2];
    r = x[0] - x[2];
  }
};

void positions_at(const Moving4& m, double t, Vec3d (&x)[4]) {
  for (int i = 0; i < 4; ++i) x[i] = m.x[i] * (1 - t) + m.p[i] * t;
}

/// Bound of the rounding error of a pair's projection on a unit vector, at any time. Errors are those of the
/// differences, three products and two sums, the length of n, the interpolation. Their sum is under 20 eps of the
/// largest component; 64 is a safe bound.
double rounding(const Moving4& m) {
  double size = 0;
  for (int i = 1; i < 4; ++i) size = max(size, max(largest(m.x[i]), largest(m.p[i])));
  return 64 * eps * size;
}

/// Time until which the hulls are separated by more than `bound` along n, from time `t` on; t if they are not
/// at t.
template <class Kind>
double separated_until(const Moving4& m, const Vec3d& n, double t, double bound) {
  double until = 1;
  for (const auto [a, b] : Kind::pairs) {
    const double begin = dot(n, m.x[a] - m.x[b]), end = dot(n, m.p[a] - m.p[b]);
    if (!(begin * (1 - t) + end * t > bound)) return t;
    if (!(end > bound)) until = min(until, (begin - bound) / (begin - end));
  }
  return max(t, until);
}

template <class Kind>
Vec3d plane_normal(const Vec3d (&x)[4]) {
  Vec3d e, f, r;
  Kind::wedge(x, e, f, r);
  const Vec3d n = normalized(cross(e, f));
  return dot(n, r) < 0 ? -n : n;
}

/// The two elements are at x at time `t`. Returns the time until which they are separated by more than `bound`; t if
/// the volume gives no such time.
template <class Kind>
double volume_until(const Moving4& m, const Vec3d (&x)[4], double t, double bound) {
  Vec3d e0, f0, r0, e1, f1, r1;
  Kind::wedge(x, e0, f0, r0);
  Kind::wedge(m.p, e1, f1, r1);
  // Bernstein coefficients over [t, 1] of n, N and |V| - bound N, for the sign of V at t.
  const Vec3d n[3] = {cross(e0, f0), 0.5 * (cross(e0, f1) + cross(e1, f0)), cross(e1, f1)};
  const double N[3] = {length(n[0]), length(n[1]), length(n[2])};
  const double V0 = dot(r0, n[0]), side = V0 < 0 ? -1 : 1;
  const double b[4] = {side * V0 - bound * N[0],
                       (side * (dot(r1, n[0]) + 2 * dot(r0, n[1])) - bound * (N[0] + 2 * N[1])) / 3,
                       (side * (2 * dot(r1, n[1]) + dot(r0, n[2])) - bound * (2 * N[1] + N[2])) / 3,
                       side * dot(r1, n[2]) - bound * N[2]};
  // Errors: n at most 6 eps area, V 24 eps area * range, a time eps. Rounding of c is at most 54 eps times the largest
  // b. Each is three or four roundings of terms whose sum is at most 27 times that.
  const double area = max(largest(e0), largest(e1)) * max(largest(f0), largest(f1));
  const double range = max(largest(r0), largest(r1)) + bound;
  const double extent = max(max(abs(b[0]), abs(b[1])), max(abs(b[2]), abs(b[3])));
  const double error = 128 * eps * (area * range + extent);
  if (!(b[0] > error)) return t;
  if (min(min(b[1], b[2]), b[3]) > error) return 1;
  const double c[4] = {b[0], 3 * (b[1] - b[0]), 3 * (b[2] - 2 * b[1] + b[0]),
                       (b[3] - b[0]) + 3 * (b[1] - b[2])};
  const CubicRoots roots = cubic_roots(c, error);
  return roots.count == 0 ? 1 : t + (1 - t) * roots.interval[0].lo;
}

/// For a motion that starts in contact, no bound can hold. The result is 1 if every corner separates along
/// the normal, else 0.
template <class Kind>
double time_from_contact(const Moving4& m, double contact_distance) {
  const Vec3d n = plane_normal<Kind>(m.x);
  for (const double side : {1.0, -1.0}) {
    bool parts = true;
    for (const auto [a, b] : Kind::pairs) {
      const double begin = side * dot(n, m.x[a] - m.x[b]), end = side * dot(n, m.p[a] - m.p[b]);
      parts = parts && begin >= -contact_distance && end > contact_distance;
    }
    if (parts) return 1;
  }
  return 0;
}

/// Needed because min and max ignore NaN.
bool all_finite(const Moving4& m) {
  Vec3d sum;
  for (int i = 0; i < 4; ++i) sum += m.x[i] + m.p[i];
  return is_finite(sum);
}

/// The cheapest test suffices for most pairs of a broad phase: the swept boxes of the two elements are separated. The
/// separation must exceed `gap` and a 1024th of any initial distance, so that the bound holds without computing that
/// distance.
template <class Kind>
bool swept_boxes_apart(const Moving4& m, double gap, double far) {
  for (int axis = 0; axis < 3; ++axis) {
    double lo[2], hi[2];
    for (const int side : {0, 1}) {
      const int begin = side == 0 ? 0 : Kind::first, end = side == 0 ? Kind::first : 4;
      lo[side] = hi[side] = m.x[begin][axis];
      for (int i = begin; i < end; ++i) {
        lo[side] = min(lo[side], min(m.x[i][axis], m.p[i][axis]));
        hi[side] = max(hi[side], max(m.x[i][axis], m.p[i][axis]));
      }
    }
    const double apart = max(lo[0] - hi[1], lo[1] - hi[0]);
    if (apart > gap && apart > 2 * far * length(m.x[0] - m.x[3])) return all_finite(m);
  }
  return false;
}

/// In the frame of particle 0, where interpolation has no larger rounding errors than differences.
Moving4 relative(const Moving4& m) {
  Moving4 r;
  for (int i = 1; i < 4; ++i) {
    r.x[i] = m.x[i] - m.x[0];
    r.p[i] = m.p[i] - m.p[0];
  }
  return r;
}

template <class Kind>
double safe_time(const Moving4& motion, double gap) {
  constexpr double close = 0.1, far = 1.0 / 1024;  // minimum parts of the initial distance, see the header
  constexpr double near_enough = 1 + 1.0 / 64;
  constexpr int advances = 64;  // typical motions need one to five

  if (swept_boxes_apart<Kind>(motion, gap, far)) return 1;
  const Moving4 m = relative(motion);
  Vec3d x[4] = {m.x[0], m.x[1], m.x[2], m.x[3]};
  Vec3d connection = Kind::connection(x);
  double distance = length(connection);
  const double contact_distance = rounding(m);
  if (!(distance > contact_distance))
    return distance <= contact_distance ? time_from_contact<Kind>(m, contact_distance) : 0;
  const double bound = (distance > gap ? max(gap, far * distance) : close * distance) + contact_distance;

  double t = 0;
  for (int k = 0; k < advances && distance > bound * near_enough; ++k) {
    double next = separated_until<Kind>(m, connection / distance, t, bound);
    if (next >= 1) return 1;
    // Rounding of a short connection's direction may be too large to prove separation; the volume does not
    // depend on it.
    if (k % 4 == 0 || !(next > t)) next = max(next, volume_until<Kind>(m, x, t, bound));
    if (next >= 1) return 1;
    if (!(next > t)) next = separated_until<Kind>(m, plane_normal<Kind>(x), t, bound);
    if (!(next > t)) return t;
    t = next;
    positions_at(m, t, x);
    connection = Kind::connection(x);
    distance = length(connection);
  }
  return t;
}

}  // namespace

double vertex_triangle_time(const Moving4& motion, double gap) {
  return safe_time<VertexTriangle>(motion, gap);
}

double edge_edge_time(const Moving4& motion, double gap) {
  return safe_time<EdgeEdge>(motion, gap);
}

}  // namespace souple
