#pragma once

#include "souple/constraints/constraint.h"
#include "souple/constraints/rest_shape.h"

#include <array>
#include <cmath>

namespace souple {

/// Orthotropic membrane (woven cloth) by St. Venant-Kirchhoff in the plane of a triangle, with separate
/// stiffnesses along warp, along weft and in shear.
///
///   F = (x1 - x0, x2 - x0) B = (f_u, f_v),  B the inverse of the rest edges in the frame of warp u, weft v
///   C = (E_uu, E_vv, 2 E_uv) = ((f_u . f_u - 1)/2, (f_v . f_v - 1)/2, f_u . f_v)   [1], Green's strain
///
/// Energy A/2 C^T S C with the stiffness S [N/m] (modulus times thickness) and the rest area A; compliance is
/// S^-1 / A [1/J]. All rows are zero at rest. Green's strain is at least -1/2. So a triangle that is crushed to a line
/// or a point has no resistance in the crushed directions, and its gradient is zero there.
struct TriangleMembrane {
  static constexpr const char* name = "triangle_membrane";
  static constexpr int arity = 3;
  static constexpr int rows = 3;
  static constexpr Sense sense = Sense::equality;

  template <class T>
  struct Params {
    T b00, b01, b10, b11;  ///< B by row: row k belongs to edge k, columns are u and v [1/m]
  };

  /// `warp` is projected onto the plane of the triangle; if it is perpendicular to that plane, the first edge
  /// is used. Throws Error when the triangle is degenerate.
  static Params<float> from_rest(const Vec3d (&x)[3], const Vec3d& warp) {
    const Vec3d e1 = x[1] - x[0], e2 = x[2] - x[0];
    const double twice_area = length(cross(e1, e2)), edge = detail::longest_edge(x);
    detail::require_valid_rest_shape(twice_area, 0.8 * edge * edge, name);
    const Vec3d normal = normalized(cross(e1, e2)), direction = normalized(warp);
    Vec3d u = direction - normal * dot(direction, normal);
    u = normalized(length(u) > 1e-6 ? u : e1);
    const Vec3d v = cross(normal, u);
    const double u1 = dot(e1, u), u2 = dot(e2, u), v1 = dot(e1, v), v2 = dot(e2, v);
    const double inverse = 1 / (u1 * v2 - u2 * v1);
    return {static_cast<float>(v2 * inverse), static_cast<float>(-u2 * inverse),
            static_cast<float>(-v1 * inverse), static_cast<float>(u1 * inverse)};
  }

  /// S^-1 / A of an orthotropic sheet, packed. Stiffnesses along warp, along weft and in shear [N/m];
  /// `poisson` is the contraction along the weft of a sheet stretched along the warp; rest area [m^2]. Throws
  /// Error when no such material exists (poisson^2 must be below warp / weft).
  static std::array<float, 6> compliance(double warp, double weft, double poisson, double shear,
                                         double area) {
    detail::require_positive(warp, "warp stiffness [N/m]");
    detail::require_positive(weft, "weft stiffness [N/m]");
    detail::require_positive(shear, "shear stiffness [N/m]");
    detail::require_positive(area, "rest area [m^2]");
    const double bound = std::sqrt(warp / weft);
    if (!(std::fabs(poisson) < bound)) detail::require_in(poisson, -bound, bound, "membrane Poisson ratio");
    return {static_cast<float>(1 / (warp * area)),
            static_cast<float>(-poisson / (warp * area)),
            static_cast<float>(1 / (weft * area)),
            0,
            0,
            static_cast<float>(1 / (shear * area))};
  }

  /// sqrt(2 A), the size of the triangle: |det B| = 1 / (2 A).
  template <class T>
  static T max_correction(const Params<T>& p) {
    return T(1) / sqrt(abs(p.b00 * p.b11 - p.b01 * p.b10));
  }

  /// The edges divide the triangle's stiffness: each gets S A of its strain energy, with the mean S of warp and weft.
  static std::array<KindLink, 3> links(const Params<float>& p, const std::array<float, 6>& alpha) {
    const float determinant = p.b00 * p.b11 - p.b01 * p.b10;
    const float rest[3][2] = {
        {0, 0}, {p.b11 / determinant, -p.b10 / determinant}, {-p.b01 / determinant, p.b00 / determinant}};
    std::array<KindLink, 3> edges{};
    for (int k = 0; k < 3; ++k) {
      const int l = (k + 1) % 3;
      const float x = rest[k][0] - rest[l][0], y = rest[k][1] - rest[l][1];
      edges[static_cast<std::size_t>(k)] = {k, l, std::sqrt(x * x + y * y), 2 / (alpha[0] + alpha[2])};
    }
    return edges;
  }

  /// Largest extension (l - l0) / l0 of the triangle in any direction: sqrt(1 + 2 e) - 1, e the larger
  /// eigenvalue of Green's strain.
  static float strain(const Params<float>&, const float (&C)[3]) {
    const float mean = 0.5f * (C[0] + C[1]), half = 0.5f * (C[0] - C[1]), shear = 0.5f * C[2];
    const float e = mean + std::sqrt(half * half + shear * shear);
    return 2 * e / (std::sqrt(std::fmax(1 + 2 * e, 0.0f)) + 1);
  }

  template <class T>
  static void evaluate(const Vec3<T> (&x)[3], const Params<T>& p, T (&C)[3], Vec3<T> (&gradient)[3][3]) {
    const Vec3<T> e1 = x[1] - x[0], e2 = x[2] - x[0];
    const Vec3<T> u = e1 * p.b00 + e2 * p.b10, v = e1 * p.b01 + e2 * p.b11;
    C[0] = (dot(u, u) - T(1)) * T(0.5f);
    C[1] = (dot(v, v) - T(1)) * T(0.5f);
    C[2] = dot(u, v);
    gradient[0][1] = u * p.b00;
    gradient[0][2] = u * p.b10;
    gradient[1][1] = v * p.b01;
    gradient[1][2] = v * p.b11;
    gradient[2][1] = v * p.b00 + u * p.b01;
    gradient[2][2] = v * p.b10 + u * p.b11;
    for (int r = 0; r < 3; ++r) gradient[r][0] = -(gradient[r][1] + gradient[r][2]);
  }
};

}  // namespace souple
