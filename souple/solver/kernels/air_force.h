#pragma once

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

/// Force of the air on a triangle with edges e and f that moves through the air at velocity v. [N] With n its
/// normal and A its area
///   drag = -rho/2 c_d A |v.n| v
///   lift = -rho/2 c_l A (v.n) |v| (n - (n.v) v / |v|^2)
/// The impulse is limited to that which stops the triangle relative to the air: light cloth stays stable in
/// any wind.
template <class T>
inline Vec3<T> air_force(const Vec3<T>& e, const Vec3<T>& f, const Vec3<T>& v, const Air& air) {
  const T speed = length(v);
  const Vec3<T> normal = cross(e, f);
  const T twice_area = length(normal);
  const auto blown = speed > T(0) && twice_area > T(0);
  const T some_speed = select(blown, speed, T(1));
  const Vec3<T> n = normal / select(blown, twice_area, T(1));
  const T vn = dot(v, n);
  const T q = T(0.25f * air.density) * twice_area;
  const Vec3<T> across = n - v * (vn / (some_speed * some_speed));
  const Vec3<T> force = v * (-q * T(air.drag) * abs(vn)) - across * (q * T(air.lift) * vn * speed);

  const T max_force = T(0.5f * air.areal_density) * twice_area * speed / T(air.h);
  const T size = length(force);
  const auto capped = size > max_force;
  const T factor = select(capped, max_force / select(capped, size, T(1)), T(1));
  return {select(blown, force.x * factor, T(0)), select(blown, force.y * factor, T(0)),
          select(blown, force.z * factor, T(0))};
}

}  // namespace souple::kernels
