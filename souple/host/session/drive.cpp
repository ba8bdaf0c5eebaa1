#include "souple/host/session/drive.h"

#include "souple/error.h"

#include <algorithm>
#include <cmath>
#include <string>

namespace souple::host {

namespace {

/// Normalized linear interpolation of two rotations: accurate enough for the few degrees of a step.
Quatd between(const Quatd& a, const Quatd& b, double s) {
  const double t = a.x * b.x + a.y * b.y + a.z * b.z + a.w * b.w < 0 ? -s : s, r = 1 - s;
  return normalized(Quatd{r * a.x + t * b.x, r * a.y + t * b.y, r * a.z + t * b.z, r * a.w + t * b.w});
}

bool is_rotation(const Mat3d& m) {
  constexpr double rounding = 1e-4;  // error of a host's floats
  const Mat3d square = transpose(m) * m + Mat3d::identity() * -1.0;
  return frobenius_squared(square) < rounding * rounding && determinant(m) > 0;
}

}  // namespace

Transform Drive::at(double time) const {
  if (!(span > 0)) return from;
  const double s = std::clamp((time - begin) / span, 0.0, 1.0);
  if (s == 1) return to;
  return {from.translation + (to.translation - from.translation) * s, between(from.rotation, to.rotation, s)};
}

void Drive::begin_step(double time, double dt) {
  begin = time;
  span = dt;
}

void Drive::end_step(bool made) {
  if (made) from = to;
  span = 0;
}

Transform rigid_motion(const Placement& from, const Placement& to, const std::string& name) {
  const Mat3d turn = to.linear() * inverse(from.linear());
  if (!is_rotation(turn))
    throw Error(name +
                ": an obstacle can be turned and moved, but not scaled, sheared or mirrored while it is "
                "in the world; remove it and add it again");
  return {to.translation() - turn * from.translation(), quaternion_of(turn)};
}

}  // namespace souple::host
