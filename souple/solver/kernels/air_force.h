#pragma once

#include "souple/math/scalar.h"
#include "souple/math/vec3.h"

namespace souple::kernels {

/// Air and the material it acts on.
struct Air {
  float wind[3] = {};  ///< m/s
  float density = 0;   ///< kg/m^3
  float drag = 0, lift = 0;
  float areal_density = 0;  ///< of the material [kg/m^2]
  float h = 0;              ///< s
};

/// Force of the air on a triangle with edges e and f that moves through the air at velocity v. [N] With N = e x f, which is
/// twice the area A times the normal n, and cos = v.N / (|v| |N|)
///   drag = -rho/2 c_d A |v.n| v                                = -rho/4 c_d |v.N| v
///   lift = -rho/2 c_l A (v.n) |v| (n - (n.v) v / |v|^2)        = -rho/4 c_l cos (|v|^2 N - (v.N) v)
/// The impulse is limited to that which stops the triangle relative to the air, |F| h <= sigma A |v|: light cloth stays
/// stable in any wind.
template <class T>
inline Vec3<T> air_force(const Vec3<T>& e, const Vec3<T>& f, const Vec3<T>& v, const Air& air) {
  const Vec3<T> N = cross(e, f);
  const T vv = dot(v, v), vN = dot(v, N);
  const T product = sqrt(vv) * length(N);
  const auto blown = product > T(0);
  const T lift = T(air.lift) * vN / select(blown, product, T(1));
  const Vec3<T> force = (v * (T(air.drag) * abs(vN) - lift * vN) + N * (lift * vv)) * T(-0.25f * air.density);

  const T most = T(0.5f * air.areal_density / air.h) * product;
  const auto limited = dot(force, force) > most * most;
  if (!any_lane(limited)) return force;
  return force * select(limited, most / select(limited, length(force), T(1)), T(1));
}

}  // namespace souple::kernels
