#include "souple/host/session/drive.h"

#include "souple/error.h"

#include <algorithm>
#include <cmath>
#include <string>

namespace souple::host {

namespace {

/// Quaternion of a rotation matrix, from its largest component to avoid division by almost zero (Shepperd
/// 1978).
Quatd quaternion_of(const Mat3d& m) {
  const double x = m(0, 0), y = m(1, 1), z = m(2, 2), w = x + y + z;
  const double a = m(2, 1) - m(1, 2), b = m(0, 2) - m(2, 0), c = m(1, 0) - m(0, 1);
  const double xy = m(0, 1) + m(1, 0), xz = m(0, 2) + m(2, 0), yz = m(1, 2) + m(2, 1);
  const double largest = std::max({x, y, z, w});
  if (largest == w) return normalized(Quatd{a, b, c, 1 + w});
  if (largest == x) return normalized(Quatd{1 + x - y - z, xy, xz, a});
  if (largest == y) return normalized(Quatd{xy, 1 + y - x - z, yz, b});
  return normalized(Quatd{xz, yz, 1 + z - x - y, c});
}

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
