#include "souple/stages/rigid_sums.h"

namespace souple {

void RigidSums::add(double m, const Vec3d& x, const Vec3d& v) {
  const Vec3d mx = x * m;
  mass += m;
  position += mx;
  momentum += v * m;
  for (int row = 0, k = 0; row < 3; ++row)
    for (int column = 0; column <= row; ++column, ++k)
      second[static_cast<std::size_t>(k)] += mx[row] * x[column];
  angular += cross(mx, v);
}

void RigidSums::add(const RigidSums& more) {
  mass += more.mass;
  position += more.position;
  momentum += more.momentum;
  for (std::size_t k = 0; k < second.size(); ++k) second[k] += more.second[k];
  angular += more.angular;
}

// With r = x - c: sum m r r^T = sum m x x^T - M c c^T.
Mat3d RigidSums::inertia() const {
  const Vec3d c = position / mass;
  const auto& s = second;
  const Mat3d moments =
      Mat3d{{s[0], s[1], s[3]}, {s[1], s[2], s[4]}, {s[3], s[4], s[5]}} - outer(c, c) * mass;
  return Mat3d::identity() * trace(moments) - moments;
}

Vec3d spin_of(const Mat3d& inertia, const Vec3d& L) {
  const double t = trace(inertia);
  return t > 0 ? inverse(inertia + Mat3d::identity() * (t * 1e-9)) * L : Vec3d{};
}

}  // namespace souple
