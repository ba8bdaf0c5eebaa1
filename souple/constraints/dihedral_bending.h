#pragma once

#include "souple/constraints/constraint.h"
#include "souple/constraints/dihedral_angle.h"
#include "souple/constraints/rest_shape.h"
#include "souple/math/elementary.h"

#include <array>

namespace souple {

/// Keeps the angle between two triangles that share the edge x0 x1 (see dihedral_angle.h).
///
///   C = |e| / sqrt(A2 + A3) (theta - theta0)   [1],   theta - theta0 in (-pi, pi]
///
/// Müller et al. 2007, section 4.1, scaled so that stiffness has a unit: |e| and the areas A2, A3 are those
/// of the rest state. The energy is 1/2 D C^2 = D/2 |e|^2/(A2 + A3) (theta - theta0)^2 with the bending
/// stiffness D per unit width [N m]; compliance alpha = 1/D [1/J]. Exact for a cylinder along an axis of a
/// regular grid: there the sum over the edges is D/2 kappa^2 times the area. Elsewhere a sheet may be too
/// stiff. At 45 degrees a grid with alternating diagonals is 1.5 times as stiff. A grid with parallel
/// diagonals is 3 times as stiff when rolled along them, and exact across them. An irregular mesh is 1.1 to
/// 1.4 times as stiff.
struct DihedralBending {
  static constexpr const char* name = "dihedral_bending";
  static constexpr int arity = 4;
  static constexpr Sense sense = Sense::equality;

  template <class T>
  struct Params {
    T scale;                   ///< |e| / sqrt(A2 + A3)
    T rest_sine, rest_cosine;  ///< of theta0
    T k1, k2, k3;              ///< see flat_gradient [1/m]
  };

  /// Edge x0 x1, opposite vertices x2 and x3. Throws Error when a triangle is degenerate.
  static Params<float> from_rest(const Vec3d (&x)[4]) {
    const Vec3d e = x[1] - x[0];
    const double edge = detail::longest_edge(x);
    const double area2 = 0.5 * length(cross(e, x[2] - x[0])), area3 = 0.5 * length(cross(e, x[3] - x[0]));
    detail::require_valid_rest_shape(std::fmin(area2, area3), 0.4 * edge * edge, name);
    const DihedralAngle<double> angle = dihedral_angle(x);
    const double norm = elementary::hypot(angle.sine, angle.cosine);
    const double scale = length(e) / std::sqrt(area2 + area3), ee = dot(e, e);
    const double k2 = scale * length(e) / (2 * area2), k3 = scale * length(e) / (2 * area3);
    const double k1 = -(k2 * dot(x[2] - x[0], e) + k3 * dot(x[3] - x[0], e)) / ee;
    return {static_cast<float>(scale),
            static_cast<float>(angle.sine / norm),
            static_cast<float>(angle.cosine / norm),
            static_cast<float>(k1),
            static_cast<float>(k2),
            static_cast<float>(k3)};
  }

  static std::array<float, 4> flat_gradient(const Params<float>& p) {
    return {-(p.k1 + p.k2 + p.k3), p.k1, p.k2, p.k3};
  }
  static bool is_flat(const Params<float>& p) {
    return !(std::fabs(p.rest_sine) > 1e-4f || p.rest_cosine < 0);
  }

  /// alpha of a bending stiffness D [N m].
  static std::array<float, 1> compliance(double bending_stiffness) {
    detail::require_positive(bending_stiffness, "bending stiffness [N m]");
    return {static_cast<float>(1 / bending_stiffness)};
  }

  template <class T>
  static T evaluate(const Vec3<T> (&x)[4], const Params<T>& p, Vec3<T> (&gradient)[4]) {
    const DihedralAngle<T> angle = dihedral_angle(x);
    for (int i = 0; i < 4; ++i) gradient[i] = angle.gradient[i] * p.scale;
    // atan2 of the sine and cosine of the difference: the difference wraps automatically.
    return p.scale * atan2(angle.sine * p.rest_cosine - angle.cosine * p.rest_sine,
                           angle.cosine * p.rest_cosine + angle.sine * p.rest_sine);
  }
};

}  // namespace souple
