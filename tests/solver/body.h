#pragma once

#include "souple/math/quaternion.h"
#include "souple/solver/projector.h"

#include <cmath>
#include <numeric>
#include <vector>

namespace souple::test {

/// Particles without constraints, with the arrays of a ParticleView.
struct Body {
  std::vector<Vec4f> position, offset, start;

  void add(const Vec3d& x, float inverse_mass) {
    const Vec3f rounded(x);
    const Vec3f rest = Vec3f(x - Vec3d(rounded));
    position.push_back({rounded.x, rounded.y, rounded.z, inverse_mass});
    offset.push_back({rest.x, rest.y, rest.z, 0});
    start = offset;
  }
  ParticleView view() { return {position, offset, start}; }
  Vec3d at(std::size_t i) const { return exact_sum(position[i], offset[i]); }
  std::vector<Vec3d> all() const {
    std::vector<Vec3d> result;
    for (std::size_t i = 0; i < position.size(); ++i) result.push_back(at(i));
    return result;
  }
  double mass(std::size_t i) const { return 1 / static_cast<double>(position[i].w); }
};

/// Momenta of a correction: sums of m dx and of m x cross dx; as scales, sums of m |dx| and of m |x| |dx|.
struct Momentum {
  Vec3d linear{}, angular{};
  double linear_scale = 0, angular_scale = 0;
};
inline Momentum momentum_of(const Body& body, const std::vector<Vec3d>& before) {
  Momentum result;
  for (std::size_t i = 0; i < before.size(); ++i) {
    const Vec3d dx = body.at(i) - before[i], x = before[i] - before[0];
    const double m = body.mass(i);
    result.linear += dx * m;
    result.angular += cross(x, dx) * m;
    result.linear_scale += m * length(dx);
    result.angular_scale += m * length(x) * length(dx);
  }
  return result;
}

inline std::vector<std::uint32_t> first(std::size_t n) {
  std::vector<std::uint32_t> result(n);
  std::iota(result.begin(), result.end(), 0u);
  return result;
}

/// Pseudo-random number in [-1, 1]; depends on i alone.
inline double scatter(std::size_t i) {
  const double x = std::sin(12.9898 * static_cast<double>(i + 1)) * 43758.5453;
  return 2 * (x - std::floor(x)) - 1;
}
inline Vec3d scatter3(std::size_t i) {
  return {scatter(3 * i), scatter(3 * i + 1), scatter(3 * i + 2)};
}

/// Runs all iterations of one substep.
inline void solve(Projector& projector, Body& body, const Substep& substep) {
  const ParticleView view = body.view();
  projector.begin_substep(view, substep);
  for (int i = 0; i < substep.iterations; ++i)
    for (int c = 0; c < projector.color_count(); ++c) projector.project(c, view, substep);
}

}  // namespace souple::test
