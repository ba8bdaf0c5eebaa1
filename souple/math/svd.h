#pragma once

#include "souple/math/mat3.h"

#include <limits>
#include <type_traits>

namespace souple {

/// M = U diag(sigma) V^T.
///
/// U and V are rotations (det = +1), so a reflection appears in the singular values: sigma.x >= sigma.y >=
/// |sigma.z|, the first two never negative, and sigma.z has the sign of det M (Irving et al. 2004, section
/// 4). The order holds to rounding. If singular values are equal or zero, U and V are not unique. The result is then
/// some choice that reproduces M, equal for equal bits.
template <class T>
struct Svd {
  Mat3<T> u;
  Vec3<T> sigma;  ///< unit of M
  Mat3<T> v;
};

namespace detail {

// True where no comparison is true. For packs it is always false: they run all sweeps, which changes no
// number.
template <class Mask>
bool none(const Mask& mask) {
  if constexpr (std::is_arithmetic_v<Mask>) {
    return !mask;
  } else {
    return false;
  }
}

template <class T>
Vec3<T> select_vector(const auto& condition, const Vec3<T>& a, const Vec3<T>& b) {
  return {select(condition, a.x, b.x), select(condition, a.y, b.y), select(condition, a.z, b.z)};
}

/// A unit vector perpendicular to the unit vector a: a x the axis on which a is smallest.
template <class T>
Vec3<T> any_perpendicular(const Vec3<T>& a) {
  const T x = abs(a.x), y = abs(a.y), z = abs(a.z);
  const auto yz = select_vector<T>(y <= z, Vec3<T>{T(0), T(1), T(0)}, Vec3<T>{T(0), T(0), T(1)});
  const auto axis = select_vector<T>(x <= min(y, z), Vec3<T>{T(1), T(0), T(0)}, yz);
  return normalized(cross(a, axis));
}

/// Rotates columns p and q of b so that they are perpendicular, and those of v likewise. Returns whether they
/// were oblique beyond rounding.
///
///   t = tan(angle) is the smaller root of t^2 + 2 zeta t - 1 = 0, zeta = (|q|^2 - |p|^2) / (2 p.q)
template <class T>
auto make_perpendicular(Vec3<T>& p, Vec3<T>& q, Vec3<T>& v_p, Vec3<T>& v_q) {
  constexpr T epsilon = std::numeric_limits<T>::epsilon();
  const T pp = dot(p, p), qq = dot(q, q), pq = dot(p, q);
  const auto oblique = pq * pq > epsilon * epsilon * max(pp, qq);
  const T difference = qq - pp;
  const T hypotenuse = abs(difference) + sqrt(difference * difference + T(4) * pq * pq);
  const T magnitude = T(2) * pq / select(hypotenuse > T(0), hypotenuse, T(1));
  const T t = select(oblique, select(difference < T(0), -magnitude, magnitude), T(0));
  const T c = T(1) / sqrt(T(1) + t * t);
  const T s = c * t;
  const Vec3<T> p_old = p, v_old = v_p;
  p = p_old * c - q * s;
  q = p_old * s + q * c;
  v_p = v_old * c - v_q * s;
  v_q = v_old * s + v_q * c;
  return oblique;
}

/// Swaps columns p and q of b where |p| < |q|, and those of v. One of each changes sign, which keeps det v.
template <class T>
void sort_descending(Vec3<T>& p, Vec3<T>& q, Vec3<T>& v_p, Vec3<T>& v_q) {
  const auto swapped = dot(p, p) < dot(q, q);
  const Vec3<T> p_old = p, v_old = v_p;
  p = select_vector<T>(swapped, q, p);
  q = select_vector<T>(swapped, -p_old, q);
  v_p = select_vector<T>(swapped, v_q, v_p);
  v_q = select_vector<T>(swapped, -v_old, v_q);
}

/// The rotation whose first column is along b0, whose second is in the plane of b0 and b1 (Gram-Schmidt), and
/// whose third completes them. f0 replaces a b0 that is too short (squared length at most `smallest`). Where
/// possible, f1 replaces a b1 that is too short or too close to the direction of b0.
template <class T>
Mat3<T> orthonormal_frame(const Vec3<T>& b0, const Vec3<T>& b1, const T& smallest, const Vec3<T>& f0,
                          const Vec3<T>& f1) {
  const T l0 = dot(b0, b0), l1 = dot(b1, b1);
  const auto long0 = l0 > smallest;
  const Vec3<T> e0 = select_vector<T>(long0, b0 / sqrt(select(long0, l0, T(1))), f0);
  const Vec3<T> p1 = b1 - e0 * dot(e0, b1);
  const Vec3<T> g1 = f1 - e0 * dot(e0, f1);
  // Where the subtraction cancels most of a vector, the rest is rounding noise.
  const T b = dot(p1, p1), g = dot(g1, g1);
  const auto b_usable = (l1 > smallest) & (b > T(0.25f) * l1);
  const auto g_usable = g > T(0.25f);
  const Vec3<T> free =
      select_vector<T>(g_usable, g1 / sqrt(select(g_usable, g, T(1))), any_perpendicular(e0));
  const Vec3<T> e1 = select_vector<T>(b_usable, p1 / sqrt(select(b_usable, b, T(1))), free);
  return {e0, e1, cross(e0, e1)};
}

}  // namespace detail

/// Singular value decomposition by one-sided Jacobi rotations (Hestenes 1958). V makes the columns of B = M V
/// perpendicular. Their lengths are the singular values, and their directions are U (Golub & Van Loan, section 8.6.3).
/// It works on M itself, never on M^T M, so small singular values keep an error of a few ulps of the largest.
///
/// T is float, double or a pack (not a dual number: skipped rotations have no derivative). M may be any
/// finite matrix: singular, zero, reflected, from 1e-38 to 1e38 in float. Where M is not finite, neither is
/// the result.
template <class T>
Svd<T> svd(const Mat3<T>& m) {
  constexpr int max_sweeps = 8;  // 1 to 6 suffice; a rotation that is not needed is exactly the identity
  constexpr T epsilon = std::numeric_limits<T>::epsilon();
  constexpr T smallest = epsilon * epsilon * epsilon * epsilon;  // of squared lengths; the largest entry is 1

  T largest = T(0);
  for (const Vec3<T>& c : m.column) largest = max(largest, max(abs(c.x), max(abs(c.y), abs(c.z))));
  const T scale = select(largest > T(0), largest, T(1));
  const Mat3<T> a{m.column[0] / scale, m.column[1] / scale, m.column[2] / scale};

  Mat3<T> b = a;
  Mat3<T> v = Mat3<T>::identity();
  for (int sweep = 0; sweep < max_sweeps; ++sweep) {
    const auto r01 = detail::make_perpendicular(b.column[0], b.column[1], v.column[0], v.column[1]);
    const auto r02 = detail::make_perpendicular(b.column[0], b.column[2], v.column[0], v.column[2]);
    const auto r12 = detail::make_perpendicular(b.column[1], b.column[2], v.column[1], v.column[2]);
    if (detail::none(r01 | r02 | r12)) break;
  }
  detail::sort_descending(b.column[0], b.column[1], v.column[0], v.column[1]);
  detail::sort_descending(b.column[0], b.column[2], v.column[0], v.column[2]);
  detail::sort_descending(b.column[1], b.column[2], v.column[1], v.column[2]);

  // v has accumulated the rotations' rounding errors. Orthonormalizing it once and recomputing B removes
  // them.
  v = detail::orthonormal_frame(v.column[0], v.column[1], smallest, v.column[0], v.column[1]);
  b = a * v;
  const Mat3<T> u = detail::orthonormal_frame(b.column[0], b.column[1], smallest, v.column[0], v.column[1]);
  const Vec3<T> sigma{dot(u.column[0], b.column[0]), max(dot(u.column[1], b.column[1]), T(0)),
                      dot(u.column[2], b.column[2])};
  return {u, sigma * scale, v};
}

}  // namespace souple
