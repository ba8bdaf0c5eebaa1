#include "souple/collision/continuous.h"

#include "souple/collision/cubic.h"
#include "souple/collision/nearest.h"

#include <limits>

// Two ways to know that nothing touches, each sound by itself.
//
// Separation. For any unit vector n, the distance of two convex hulls is at least the least n . (x_a - x_b)
// over their pairs of corners. While n stays and corners move straight, each of these is linear in time, so
// they say until when the distance is above a bound, exactly and not by a Lipschitz constant: motion across n
// costs nothing. With n along the shortest connection this is conservative advancement (Mirtich 1996,
// section 2.3; Li et al. 2021, "Codimensional IPC", algorithm 1, advance by the length of the motion instead,
// which makes a vertex that slides along a triangle crawl). Any n is sound, so nothing hangs on how exactly
// it was computed.
//
// Volume. With e, f, r as in Wedge, V(t) = r . (e x f) is a cubic, and |V| / |e x f| is the distance of the
// particle to the plane, or of the two lines: it bounds the distance. Where |V| is above bound * max |e x f|
// nothing is near (Provot 1997 asks for V = 0). If the four Bernstein coefficients say so there is no root to
// look for; else the intervals of cubic.h remain, and separation advances within them.

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
  static constexpr Pair pairs[] = {{0, 2}, {0, 3}, {1, 2}, {1, 3}};

  /// From the nearest point of edge 2, 3 to that of edge 0, 1.
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

/// What the projection of a pair on a unit vector, at any time, may be wrong by: the difference, three
/// products and two sums, the length of n, the interpolation; under 16 eps of the largest component, 64
/// leaves room.
template <class Kind>
double rounding(const Moving4& m) {
  double size = 0;
  for (const auto [a, b] : Kind::pairs) {
    size = max(size, max(largest(m.x[a] - m.x[b]), largest(m.p[a] - m.p[b])));
  }
  return 64 * eps * size;
}

/// Until when the hulls stay apart by more than `bound` along n, given that it is now `t`; t where they are
/// not.
template <class Kind>
double apart_until(const Moving4& m, const Vec3d& n, double t, double bound) {
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

/// Volume: the times at which the two may be closer than `bound`, one interval [0, 1] where nothing is known.
template <class Kind>
CubicRoots near_plane(const Moving4& m, double bound) {
  Vec3d e0, f0, r0, e1, f1, r1;
  Kind::wedge(m.x, e0, f0, r0);
  Kind::wedge(m.p, e1, f1, r1);
  // Bernstein coefficients over [0, 1] of e x f, and of r . (e x f).
  const Vec3d n0 = cross(e0, f0), n1 = 0.5 * (cross(e0, f1) + cross(e1, f0)), n2 = cross(e1, f1);
  const double b0 = dot(r0, n0), b1 = (dot(r1, n0) + 2 * dot(r0, n1)) / 3;
  const double b2 = (2 * dot(r1, n1) + dot(r0, n2)) / 3, b3 = dot(r1, n2);
  // n1 .. n3 are wrong by at most 6 eps areas, b0 .. b3 by 24 eps areas * reach, and what c rounds by 54 eps
  // largest b: each coefficient is three or four roundings of terms whose sum is at most 27 times that.
  const double area = max(largest(e0), largest(e1)) * max(largest(f0), largest(f1));
  const double reach = max(largest(r0), largest(r1));
  const double normal = sqrt(max(max(length_squared(n0), length_squared(n1)), length_squared(n2)));
  const double extent = max(max(abs(b0), abs(b1)), max(abs(b2), abs(b3)));
  const double error = bound * (normal + 16 * eps * area) + 64 * eps * (area * reach + extent);

  const double lowest = min(min(b0, b1), min(b2, b3)), highest = max(max(b0, b1), max(b2, b3));
  if (lowest > error || highest < -error) return {};
  const double c[4] = {b0, 3 * (b1 - b0), 3 * (b2 - 2 * b1 + b0), (b3 - b0) + 3 * (b1 - b2)};
  return cubic_roots(c, error);
}

/// In touch at the begin: no bound can hold, but they may part at once, along the normal and at every corner.
template <class Kind>
double parting(const Moving4& m, double touch) {
  const Vec3d n = plane_normal<Kind>(m.x);
  for (const double side : {1.0, -1.0}) {
    bool parts = true;
    for (const auto [a, b] : Kind::pairs) {
      const double begin = side * dot(n, m.x[a] - m.x[b]), end = side * dot(n, m.p[a] - m.p[b]);
      parts = parts && begin >= -touch && end > touch;
    }
    if (parts) return 1;
  }
  return 0;
}

template <class Kind>
double safe_time(const Moving4& m, double gap) {
  constexpr double close = 0.1, far = 1.0 / 1024;  // what must remain of the distance, see the header
  constexpr double near_enough = 1 + 1.0 / 64;
  constexpr int advances = 64;  // ordinary motions need one to five

  const Vec3d first = Kind::connection(m.x);
  const double distance = length(first), touch = rounding<Kind>(m);
  if (!(distance > touch)) return distance <= touch ? parting<Kind>(m, touch) : 0;
  const double bound = (distance > gap ? max(gap, far * distance) : close * distance) + touch;
  double t = apart_until<Kind>(m, first / distance, 0, bound);
  if (t >= 1) return 1;

  const CubicRoots near = near_plane<Kind>(m, bound);
  int left = advances;
  for (int k = 0; k < near.count; ++k) {
    t = max(t, near.interval[k].lo);
    while (t < near.interval[k].hi) {
      Vec3d x[4];
      positions_at(m, t, x);
      const Vec3d connection = Kind::connection(x);
      const double now = length(connection);
      if (!(now > bound * near_enough) || left-- == 0) return t;
      double next = apart_until<Kind>(m, connection / now, t, bound);
      // A short connection's direction is rounded too much to part anything; the normal's is not.
      if (next <= t) next = apart_until<Kind>(m, plane_normal<Kind>(x), t, bound);
      if (!(next > t)) return t;
      if (next >= 1) return 1;
      t = next;
    }
  }
  return 1;
}

}  // namespace

double vertex_triangle_time(const Moving4& motion, double gap) {
  return safe_time<VertexTriangle>(motion, gap);
}

double edge_edge_time(const Moving4& motion, double gap) {
  return safe_time<EdgeEdge>(motion, gap);
}

}  // namespace souple
