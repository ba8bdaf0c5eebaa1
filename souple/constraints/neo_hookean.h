#pragma once

#include "souple/constraints/constraint.h"
#include "souple/constraints/rest_shape.h"

#include <array>

namespace souple {

/// A soft tetrahedron with the stable neo-Hookean energy of Smith et al. 2018 and Macklin and Müller 2021. It has two
/// rows, both zero at rest.
///
///   F = (x1 - x0, x2 - x0, x3 - x0) B,  B the inverse of the rest edges,  I = |F|^2,  J = det F
///   C = (D, J - 1)   [1],   D^2 = I + J^2 - 4 J >= 0
///   V (mu/2 D^2 + lambda/2 (J - 1)^2) = V (mu/2 (I - 3) - mu (J - 1) + (lambda + mu)/2 (J - 1)^2)
///
/// with Lamé's mu and lambda [Pa]. The right side is the energy of the papers and already includes the
/// corrections of the rest shape and of lambda that this energy needs. The rows of the papers, sqrt(I) and J - 1 -
/// mu/lambda, do not vanish at rest. They oppose each other, and converge to a wrong volume when projected one after
/// the other. D vanishes for rotations; compliance is diag(1/(mu V), 1/(lambda V)) [1/J].
///
/// Near rest the terms of D^2 and of its gradient cancel. With Green's strain E = (F^T F - 1)/2 and j = J - 1,
/// these forms keep their digits:
///
///   D^2 = 2 |E|^2 + 2 s (j + tr E) - 8 det E,   s = j - tr E = (4 m2 + 8 det E - j tr E) / (J + 1),
///   D dD/dF = F + (J - 2) cof F = 2/J F ((s + j tr E) 1 + (1 - j) E - 2 (1 - j) cof E),
///
/// Here m2 is the sum of the principal 2 x 2 minors of E.
///
/// The direction of dD rotates with the strain, but stored multipliers do not. So few, long substeps of many iterations
/// give a wrong equilibrium under load. With 2 substeps of 5 to 40 iterations at 60 Hz, 1e5 Pa and 10 cm cells, a
/// Poisson's ratio of 0.3 appears as 0.36. With 10 substeps it is right within 2 %. Prefer substeps to iterations.
///
/// D^2 also vanishes at F = 0, which would trap a tet that was crushed to a point. So where I < 1 (at rest
/// I = 3), (1 - I)^2 is added to D^2, and only the rest shape is a minimum. A tet that was crushed to a line
/// or a point opens in the orientation of its rest shape.
struct NeoHookean {
  static constexpr const char* name = "neo_hookean";
  static constexpr int arity = 4;
  static constexpr int rows = 2;
  static constexpr Sense sense = Sense::equality;

  template <class T>
  struct Params {
    Mat3<T> rest_inverse;  ///< B [1/m]
  };

  /// Throws Error when the tet is flat or inverted.
  static Params<float> from_rest(const Vec3d (&x)[4]) {
    const Mat3d edges{x[1] - x[0], x[2] - x[0], x[3] - x[0]};
    const double edge = detail::longest_edge(x);
    detail::require_valid_rest_shape(determinant(edges) / 6, 0.1 * edge * edge * edge, name);
    return {Mat3f(inverse(edges))};
  }

  /// Packed compliance from Young's modulus [Pa], Poisson's ratio in [0, 0.5) and rest volume [m^3]. For a
  /// Poisson's ratio of 0 the volume row is practically absent: its stiffness is a millionth of that
  /// of the other row.
  static std::array<float, 3> compliance(double young_modulus, double poisson_ratio, double rest_volume) {
    detail::require_positive(young_modulus, "Young's modulus [Pa]");
    detail::require_in(poisson_ratio, 0, 0.5, "Poisson's ratio");
    detail::require_positive(rest_volume, "rest volume [m^3]");
    const double mu = young_modulus / (2 * (1 + poisson_ratio));
    const double lambda = 2 * mu * poisson_ratio / (1 - 2 * poisson_ratio);
    return {static_cast<float>(1 / (mu * rest_volume)), 0,
            static_cast<float>(1 / (std::fmax(lambda, 1e-6 * mu) * rest_volume))};
  }

  /// About the smallest height of the rest tet.
  template <class T>
  static T max_correction(const Params<T>& p) {
    return sqrt(T(3) / frobenius_squared(p.rest_inverse));
  }

  /// Compliance that one sweep adds to the stiffer row at rest, relative to it, at h = 1 s: [1/s^2]
  static float softness(const Params<float>& p, const std::array<float, 3>& alpha, const float (&w)[4]) {
    const Mat3f edges = transpose(p.rest_inverse);
    float sum = w[0] * dot(edges.column[0] + edges.column[1] + edges.column[2],
                           edges.column[0] + edges.column[1] + edges.column[2]);
    for (int k = 0; k < 3; ++k) sum += w[k + 1] * dot(edges.column[k], edges.column[k]);
    return sum / (2 * std::fmin(alpha[0], alpha[2]));
  }

  /// Bound of the extension (l - l0) / l0 of the tet in any direction, exact where the tet is pulled along one
  /// axis alone. With singular values s >= t >= u of F, I = s^2 + t^2 + u^2 >= s^2 + 2 t u = s^2 + 2 J/s. So s
  /// is at most the largest root of s^2 + 2 J/s = I. With s = 1 + e, J = 1 + j and I from D,
  ///   f(e) = e^2 (3 + e) - 2 j e + (j^2 - D^2) (1 + e) = 0,
  /// by Newton's iteration from e = D, where f >= 0. Where the tet is crushed (I < 1), D is larger than the
  /// formula assumes, and so is the bound.
  static float strain(const Params<float>&, const float (&C)[2]) {
    const float D = C[0], j = C[1], rest = (j - D) * (j + D);
    float e = D;
    for (int i = 0; i < 6; ++i) {
      const float f = e * e * (3 + e) - 2 * j * e + rest * (1 + e);
      const float slope = 3 * e * e + 6 * e - 2 * j + rest;
      e -= slope > 0 ? f / slope : 0;
    }
    return e;
  }

  template <class T>
  static void evaluate(const Vec3<T> (&x)[4], const Params<T>& p, T (&C)[2], Vec3<T> (&gradient)[2][4]) {
    const Mat3<T> F = opened(Mat3<T>{x[1] - x[0], x[2] - x[0], x[3] - x[0]} * p.rest_inverse);
    const Mat3<T> cof = cofactor(F);
    const T J = dot(F.column[0], cof.column[0]);
    const Strain<T> near = near_rest(F, J), far = far_from_rest(F, cof, J);
    // A reflection has zero strain too, but is far from rest.
    const auto is_near = select(J > T(0), near.size, T(1)) < T(0.05f);
    C[0] = select(is_near, near.D, far.D);
    C[1] = select(is_near, near.j, J - T(1));
    Mat3<T> dD;
    for (int k = 0; k < 3; ++k) dD.column[k] = choose(is_near, near.dD.column[k], far.dD.column[k]);
    particle_gradients(dD, p.rest_inverse, gradient[0]);
    particle_gradients(cof, p.rest_inverse, gradient[1]);
  }

 private:
  template <class T>
  struct Strain {
    T D{}, j{}, size{};  ///< size = |E|^2, near rest only
    Mat3<T> dD;
  };

  template <class Mask, class T>
  static Vec3<T> choose(const Mask& mask, const Vec3<T>& a, const Vec3<T>& b) {
    return {select(mask, a.x, b.x), select(mask, a.y, b.y), select(mask, a.z, b.z)};
  }

  /// F; if all four points are collinear, F plus a tiny rest shape, because collinear points have no gradient
  /// that separates them.
  template <class T>
  static Mat3<T> opened(const Mat3<T>& F) {
    const T I = frobenius_squared(F);
    const T spread_out = frobenius_squared(cofactor(F)) - T(1e-15f) * I * I;
    const T tiny = select(min(spread_out, I - T(1e-12f)) > T(0), T(0), T(1e-6f));
    return F + Mat3<T>::diagonal({tiny, tiny, tiny});
  }

  /// Accurate where |E| is small and J > 0; finite elsewhere.
  template <class T>
  static Strain<T> near_rest(const Mat3<T>& F, const T& J) {
    const Vec3<T>&a = F.column[0], &b = F.column[1], &c = F.column[2];
    const T half = T(0.5f), one = T(1), two = T(2), four = T(4);
    const T xx = (dot(a, a) - one) * half, yy = (dot(b, b) - one) * half, zz = (dot(c, c) - one) * half;
    const T xy = dot(a, b) * half, yz = dot(b, c) * half, zx = dot(c, a) * half;
    const Mat3<T> E{{xx, xy, zx}, {xy, yy, yz}, {zx, yz, zz}};
    const Mat3<T> cof = cofactor(E);
    const T tr = trace(E), m2 = trace(cof), det = dot(E.column[0], cof.column[0]);
    // J + 1 = 2 + j, j (J + 1) = J^2 - 1 = 2 tr E + 4 m2 + 8 det E.
    const T sum = max(J, T(0)) + one;
    const T j = (two * tr + four * m2 + T(8) * det) / sum;
    const T s = (four * m2 + T(8) * det - j * tr) / sum;

    Strain<T> near;
    near.j = j;
    near.size = frobenius_squared(E);
    const T DD = two * near.size + two * s * (j + tr) - T(8) * det;
    const auto strained = DD > T(1e-12f);
    const T root = sqrt(select(strained, DD, one));
    near.D = select(strained, root, T(0));
    const T factor = select(strained, two / (root * max(one + j, half)), T(0));
    const T diagonal = s + j * tr, linear = one - j;
    const Mat3<T> S = Mat3<T>::diagonal({diagonal, diagonal, diagonal}) + E * linear - cof * (two * linear);
    near.dD = (F * S) * factor;
    return near;
  }

  template <class T>
  static Strain<T> far_from_rest(const Mat3<T>& F, const Mat3<T>& cof, const T& J) {
    const T I = frobenius_squared(F), two = T(2);
    const T crushed = max(T(0), T(1) - I);
    Strain<T> far;
    const T DD = I + J * J - T(4) * J + crushed * crushed;
    far.D = sqrt(max(DD, T(1e-12f)));
    far.dD = (F * (T(1) - two * crushed) + cof * (J - two)) * (T(1) / far.D);
    return far;
  }

  /// Gradients at the four particles from dC/dF: dC/dx_k = dC/dF B^T e_k.
  template <class T>
  static void particle_gradients(const Mat3<T>& dF, const Mat3<T>& rest_inverse, Vec3<T> (&gradient)[4]) {
    const Mat3<T> edges = dF * transpose(rest_inverse);
    for (int k = 0; k < 3; ++k) gradient[k + 1] = edges.column[k];
    gradient[0] = -(edges.column[0] + edges.column[1] + edges.column[2]);
  }
};

}  // namespace souple
