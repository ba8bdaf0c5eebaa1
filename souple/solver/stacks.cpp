#include "souple/solver/stacks.h"

#include <algorithm>
#include <numeric>
#include <utility>

namespace souple {
namespace {

template <class Body>
bool touch(const Body& a, const Body& b) {
  for (int axis = 0; axis < 3; ++axis)
    if (a.lo[axis] > b.hi[axis] || b.lo[axis] > a.hi[axis]) return false;
  return true;
}

}  // namespace

void Stacks::resize(std::size_t bodies) {
  bodies_.resize(bodies);
  if (by_x_.size() == bodies) return;
  by_x_.resize(bodies), groups_.resize(bodies);
  std::iota(by_x_.begin(), by_x_.end(), 0u);
}

void Stacks::set(std::size_t body, const Vec3f& lo, const Vec3f& hi, double mass) {
  bodies_[body] = {lo, hi, mass};
}

void Stacks::find() {
  const auto x = [&](std::size_t k) { return bodies_[by_x_[k]].lo.x; };
  for (std::size_t k = 1; k < by_x_.size(); ++k)
    for (std::size_t j = k; j > 0 && x(j) < x(j - 1); --j) std::swap(by_x_[j], by_x_[j - 1]);
  connected_.reset(bodies_.size());
  for (std::size_t i = 0; i < bodies_.size(); ++i) groups_[i] = {1, bodies_[i].mass, bodies_[i].mass};
  for (std::size_t k = 0; k < by_x_.size(); ++k) {
    const std::uint32_t a = by_x_[k];
    for (std::size_t j = k + 1; j < by_x_.size() && !(x(j) > bodies_[a].hi.x); ++j) {
      const std::uint32_t b = by_x_[j];
      if (!(bodies_[a].mass > 0) || !(bodies_[b].mass > 0) || !touch(bodies_[a], bodies_[b])) continue;
      const Group one = groups_[connected_.root(a)], other = groups_[connected_.root(b)];
      if (!connected_.join(a, b)) continue;
      groups_[connected_.root(a)] = {one.bodies + other.bodies, std::min(one.lightest, other.lightest),
                                     std::max(one.heaviest, other.heaviest)};
    }
  }
}

Stacks::Size Stacks::size_of(std::uint32_t body) {
  const Group& group = groups_[connected_.root(body)];
  return {group.bodies, group.heaviest / group.lightest};
}

}  // namespace souple
