#pragma once

#include "souple/math/disjoint_sets.h"
#include "souple/math/vec3.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace souple {

/// Groups of bodies whose bounding boxes touch, directly or through others.
class Stacks {
 public:
  /// Size of a group, or the largest values of some.
  struct Size {
    std::size_t bodies = 1;
    double mass_ratio = 1;  ///< heaviest to lightest body of a group
    void add(const Size& other) {
      bodies = std::max(bodies, other.bodies), mass_ratio = std::max(mass_ratio, other.mass_ratio);
    }
  };

  /// Number of bodies; call `set` for each of them before `find`. Allocates only when there are more than ever before.
  void resize(std::size_t bodies);
  /// A body with a box [lo, hi] [m] and a mass [kg]. A mass of 0 takes part in no group.
  void set(std::size_t body, const Vec3f& lo, const Vec3f& hi, double mass);
  /// Sorts the boxes along x, where they are nearly sorted from the last call, and joins those that overlap.
  void find();
  /// Size of the group of a body, as `find` found it.
  Size size_of(std::uint32_t body);

 private:
  struct Body {
    Vec3f lo, hi;
    double mass = 0;
  };
  struct Group {
    std::size_t bodies;
    double lightest, heaviest;
  };
  std::vector<Body> bodies_;
  std::vector<std::uint32_t> by_x_;
  DisjointSets connected_;
  std::vector<Group> groups_;  // at the roots
};

}  // namespace souple
