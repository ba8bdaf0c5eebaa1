#pragma once

#include "souple/math/vec3.h"

#include <cstdint>
#include <span>
#include <vector>

namespace souple::render {

/// Finds the nearest of many points (a k-d tree). Of points that are equally near, the first.
class PointTree {
 public:
  explicit PointTree(std::span<const Vec3f> points);

  /// Its position in `points`; 0 when there is none.
  std::uint32_t nearest(const Vec3f& to) const;

 private:
  struct Node {
    Vec3f point;
    std::uint32_t index = 0;
    int axis = 0;  ///< children before the node are smaller or equal along it, those behind larger or equal
  };
  struct Best;

  void build(std::size_t begin, std::size_t end);
  void search(std::size_t begin, std::size_t end, const Vec3f& to, Best& best) const;

  std::vector<Node> nodes_;  ///< the node of a range is its middle one
};

}  // namespace souple::render
