#pragma once

#include "souple/constraints/constraint.h"
#include "souple/constraints/rest_shape.h"

#include <array>

namespace souple {

/// Flattens two triangles that share the edge x0 x1; the energy is quadratic in the positions. Bergou et al.
/// 2006, section 4. Assumes a surface that stretches little and is flat at rest.
///
///   K x = |e| (t2 + t3) / sqrt(A2 + A3) at rest, t_i the unit normal of the edge in triangle i towards x_i:
///         with height H_i and foot f_i of x_i on the edge, |e| t_i = |e|/H_i (x_i - (1 - f_i) x0 - f_i x1)
///   |K x| = |e| / sqrt(A2 + A3) 2 sin(theta/2) while the triangles are undeformed
///   C = |K x|   [1]
///
/// Energy 1/2 D C^2 with the bending stiffness D per unit width [N m]; compliance alpha = 1/D [1/J]. Without
/// the factor 3 of the paper, a cylinder along an axis of a regular grid has exactly D/2 kappa^2 per area.
/// When flat, C is 0 and the direction undefined: C and gradient are zero while K x is below the rounding of
/// its terms.
struct IsometricBending {
  static constexpr const char* name = "isometric_bending";
  static constexpr int arity = 4;
  static constexpr Sense sense = Sense::equality;

  template <class T>
  struct Params {
    T k1, k2, k3;  ///< K_i / sqrt(A2 + A3) [1/m]; K_0 is minus their sum
  };

  /// Edge x0 x1, opposite vertices x2 and x3. The rest state is their unfolding into a plane, whatever their
  /// current angle. Throws Error when a triangle is degenerate.
  static Params<float> from_rest(const Vec3d (&x)[4]) {
    const Vec3d e = x[1] - x[0];
    const double edge = detail::longest_edge(x), ee = dot(e, e);
    const double twice2 = length(cross(e, x[2] - x[0])), twice3 = length(cross(e, x[3] - x[0]));
    detail::require_valid_rest_shape(std::fmin(twice2, twice3), 0.8 * edge * edge, name);
    // Triangle of height H = twice / |e|, apex above foot f: |e| times the unit vector from the foot to the
    // apex is |e| / H (x2 - (1 - f) x0 - f x1). The sum over both triangles vanishes when flat.
    const double scale = 1 / std::sqrt(0.5 * (twice2 + twice3));
    const double k2 = scale * ee / twice2, k3 = scale * ee / twice3;
    const double foot2 = dot(x[2] - x[0], e) / ee, foot3 = dot(x[3] - x[0], e) / ee;
    const double k1 = -(k2 * foot2 + k3 * foot3);
    return {static_cast<float>(k1), static_cast<float>(k2), static_cast<float>(k3)};
  }

  static std::array<float, 4> flat_gradient(const Params<float>& p) {
    return {-(p.k1 + p.k2 + p.k3), p.k1, p.k2, p.k3};
  }

  /// alpha of a bending stiffness D [N m].
  static std::array<float, 1> compliance(double bending_stiffness) {
    detail::require_positive(bending_stiffness, "bending stiffness [N m]");
    return {static_cast<float>(1 / bending_stiffness)};
  }

  template <class T>
  static T evaluate(const Vec3<T> (&x)[4], const Params<T>& p, Vec3<T> (&gradient)[4]) {
    const Vec3<T> v1 = (x[1] - x[0]) * p.k1, v2 = (x[2] - x[0]) * p.k2, v3 = (x[3] - x[0]) * p.k3;
    const Vec3<T> v = v1 + v2 + v3;
    const T rounding = T(1e-13f) * (dot(v1, v1) + dot(v2, v2) + dot(v3, v3));
    const T vv = dot(v, v);
    const auto bent = vv > rounding;
    const T l = sqrt(select(bent, vv, T(1)));
    const Vec3<T> n = v * select(bent, T(1) / l, T(0));
    gradient[1] = n * p.k1;
    gradient[2] = n * p.k2;
    gradient[3] = n * p.k3;
    gradient[0] = -(gradient[1] + gradient[2] + gradient[3]);
    return select(bent, l, T(0));
  }
};

}  // namespace souple
