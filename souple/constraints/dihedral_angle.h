#pragma once

#include "souple/math/vec3.h"

namespace souple {

/// Signed angle between two triangles that share the edge x0 x1, as a vector (sine, cosine) of any length,
/// and the gradient of the angle.
template <class T>
struct DihedralAngle {
  T sine{}, cosine{};   ///< both times one positive factor; (0, 0) where the angle is undefined
  Vec3<T> gradient[4];  ///< of the angle [1/m]; zero where it is undefined
};

/// Angle of triangle (x1, x0, x3) to triangle (x0, x1, x2). It is 0 if both lie in a plane on opposite sides of the
/// edge, and +-pi if folded shut. It is positive if x3 is on the side of the normal n2 = e x (x2 - x0).
///
///   e = x1 - x0,  n2 = e x (x2 - x0),  n3 = (x3 - x0) x e
///   theta = atan2(|e| n2 . (x3 - x0), n2 . n3)
///   grad_2 = |e| n2 / |n2|^2,  grad_3 = |e| n3 / |n3|^2
///
/// The gradients at x0 and x1 balance these two, in proportion to where the feet of x2 and x3 divide the
/// edge. Sources: Bridson et al. 2003, section 4, and Müller et al. 2007, section 4.1 and appendix A. Deviation: atan2
/// replaces their acos, whose gradient is 0/0 when flat and when folded. Where the points of a triangle are collinear
/// (sine below 1e-6), the angle is undefined.
template <class T>
DihedralAngle<T> dihedral_angle(const Vec3<T> (&x)[4]) {
  const Vec3<T> e = x[1] - x[0], d2 = x[2] - x[0], d3 = x[3] - x[0];
  const Vec3<T> n2 = cross(e, d2), n3 = cross(d3, e);
  const T ee = dot(e, e), nn2 = dot(n2, n2), nn3 = dot(n3, n3);
  const T edge = sqrt(ee);
  const T flat = T(1e-12f) * ee;
  const T low2 = nn2 - flat * dot(d2, d2), low3 = nn3 - flat * dot(d3, d3);
  const auto usable = min(low2, low3) > T(0);

  DihedralAngle<T> angle;
  angle.sine = select(usable, edge * dot(n2, d3), T(0));
  angle.cosine = select(usable, dot(n2, n3), T(0));
  angle.gradient[2] = n2 * select(usable, edge / select(usable, nn2, T(1)), T(0));
  angle.gradient[3] = n3 * select(usable, edge / select(usable, nn3, T(1)), T(0));
  const T inverse_ee = select(usable, T(1) / select(usable, ee, T(1)), T(0));
  const T foot2 = dot(d2, e) * inverse_ee, foot3 = dot(d3, e) * inverse_ee;
  angle.gradient[0] = angle.gradient[2] * (foot2 - T(1)) + angle.gradient[3] * (foot3 - T(1));
  angle.gradient[1] = -(angle.gradient[2] * foot2 + angle.gradient[3] * foot3);
  return angle;
}

}  // namespace souple
