#pragma once

#include "souple/math/scalar.h"
#include "souple/math/vec3.h"

namespace souple::kernels {

/// Air and the material it acts on.
struct Air {
  float wind[3] = {};  ///< m/s
  float density = 0;   ///< kg/m^3
  float drag = 0, lift = 0;
};

/// Force of the air on a triangle with edges e and f that moves through the air at velocity v, at this speed. [N] With
/// N = e x f, which is twice the area A times the normal n, and cos = v.N / (|v| |N|)
///   drag = -rho/2 c_d A |v.n| v                                = -rho/4 c_d |v.N| v
///   lift = -rho/2 c_l A (v.n) |v| (n - (n.v) v / |v|^2)        = -rho/4 c_l cos (|v|^2 N - (v.N) v)
template <class T>
inline Vec3<T> air_force(const Vec3<T>& e, const Vec3<T>& f, const Vec3<T>& v, const T& speed,
                         const Air& air) {
  const Vec3<T> N = cross(e, f);
  const T vN = dot(v, N), product = speed * length(N);
  const auto blown = product > T(0);
  const T lift = T(air.lift) * vN / select(blown, product, T(1));
  return (v * (T(air.drag) * abs(vN) - lift * vN) + N * (lift * dot(v, v))) * T(-0.25f * air.density);
}

}  // namespace souple::kernels
