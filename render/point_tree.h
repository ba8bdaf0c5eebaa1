#pragma once

#include "souple/math/vec3.h"

#include <cstdint>
#include <span>
#include <vector>

namespace souple::render {

/// Finds the nearest of many points with a k-d tree; of equally near points, the first.
class PointTree {
 public:
  explicit PointTree(std::span<const Vec3f> points);

  /// Index of the nearest point in `points`; 0 without points.
  std::uint32_t nearest(const Vec3f& to) const;

 private:
  struct Node {
    Vec3f point;
    std::uint32_t index = 0;
    int axis = 0;  ///< children before the node have coordinates <= the node's, children after it >=
  };
  struct Best;

  void build(std::size_t begin, std::size_t end);
  void search(std::size_t begin, std::size_t end, const Vec3f& to, Best& best) const;

  std::vector<Node> nodes_;  ///< the root of a range is its middle node
};

}  // namespace souple::render
