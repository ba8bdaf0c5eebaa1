#pragma once

#include "souple/math/quaternion.h"

namespace souple {

/// From a (s = 0) to b (s = 1) along the shorter arc at constant speed; both are unit quaternions.
///   slerp(a, b, s) = (sin((1 - s) angle) a + sin(s angle) b) / sin(angle)   (Shoemake 1985)
/// For angles too small for a division by their sine, linear interpolation is as good.
inline Quatd slerp(const Quatd& a, Quatd b, double s) {
  double cosine = a.x * b.x + a.y * b.y + a.z * b.z + a.w * b.w;
  if (cosine < 0) {
    b = {-b.x, -b.y, -b.z, -b.w};
    cosine = -cosine;
  }
  double weight_a = 1 - s, weight_b = s;
  const double angle = elementary::acos(min(cosine, 1.0));
  if (angle > 1e-6) {
    weight_a = elementary::sin((1 - s) * angle) / elementary::sin(angle);
    weight_b = elementary::sin(s * angle) / elementary::sin(angle);
  }
  return normalized(Quatd{weight_a * a.x + weight_b * b.x, weight_a * a.y + weight_b * b.y,
                          weight_a * a.z + weight_b * b.z, weight_a * a.w + weight_b * b.w});
}

}  // namespace souple
