#include "souple/host/session/drive.h"

#include "souple/collision/collider_motion.h"
#include "souple/error.h"

#include <string>

namespace souple::host {

namespace {

bool is_rotation(const Mat3d& m) {
  constexpr double rounding = 1e-4;  // error of a host's floats
  const Mat3d square = transpose(m) * m + Mat3d::identity() * -1.0;
  return frobenius_squared(square) < rounding * rounding && determinant(m) > 0;
}

}  // namespace

Transform Drive::at(double time) const {
  return span > 0 ? interpolate(from, to, (time - begin) / span) : from;
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
