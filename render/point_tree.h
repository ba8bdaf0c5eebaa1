#pragma once

#include "souple/math/vec3.h"

#include <cstdint>
#include <span>
#include <vector>

namespace souple::render {

/// Nearest-point search (k-d tree). Among equally near points it returns the first.
class PointTree {
 public:
  explicit PointTree(std::span<const Vec3f> points);

  /// Index of the nearest point in `points`; 0 if there is none.
  std::uint32_t nearest(const Vec3f& to) const;

 private:
  struct Node {
    Vec3f point;
    std::uint32_t index = 0;
    /// Points before the node are smaller or equal along this axis, points after it larger or equal.
    int axis = 0;
  };
  struct Best;

  void build(std::size_t begin, std::size_t end);
  void search(std::size_t begin, std::size_t end, const Vec3f& to, Best& best) const;

  std::vector<Node> nodes_;  ///< the node of a range is its middle element
};

}  // namespace souple::render
