#include "souple/studies/integrators.h"

#include "souple/math/mat3.h"

namespace souple {
namespace {

// Solves v = v0 + h a(x + h v, v, t) by Newton's method with a 3 x 3 Jacobian from central differences. The
// wind on triangles is that of the substep's start.
Vec3f implicit_velocity(const ExternalForces& forces, std::size_t i, const Vec3f& x, const Vec3f& v0, float h,
                        double t) {
  const auto residual = [&](const Vec3f& v) { return v - v0 - acceleration(forces, i, x + v * h, v, t) * h; };
  // The step of the difference quotient is small compared to v and h a, but far above float's rounding.
  Vec3f v = v0;
  for (int iteration = 0; iteration < 8; ++iteration) {
    const Vec3f r = residual(v);
    const float scale = length(v) + length(r) + 1e-3f;
    if (!(length(r) > 1e-6f * scale)) break;
    const float e = 1e-2f * scale;
    Mat3f jacobian;
    for (int k = 0; k < 3; ++k) {
      Vec3f ahead = v, behind = v;
      ahead[k] += e, behind[k] -= e;
      jacobian.column[k] = (residual(ahead) - residual(behind)) / (2 * e);
    }
    const Vec3f dv = inverse(jacobian) * r;
    if (!is_finite(dv)) break;
    v -= dv;
  }
  return v;
}

Predicted explicit_euler(const ExternalForces& forces, std::size_t i, const Vec3f& x, const Vec3f& v, float h,
                         double t) {
  return {v + acceleration(forces, i, x, v, t) * h, v * h};
}

Predicted implicit_euler(const ExternalForces& forces, std::size_t i, const Vec3f& x, const Vec3f& v, float h,
                         double t) {
  const Vec3f end = implicit_velocity(forces, i, x, v, h, t + static_cast<double>(h));
  return {end, end * h};
}

}  // namespace

Integrate integrate_by(Integrator integrator) {
  if (integrator == Integrator::explicit_euler) return explicit_euler;
  return integrator == Integrator::implicit_euler ? implicit_euler : nullptr;
}

}  // namespace souple
