#include "render/point_tree.h"

#include <algorithm>
#include <limits>

namespace souple::render {

struct PointTree::Best {
  float distance_squared = std::numeric_limits<float>::max();
  std::uint32_t index = 0;
};

PointTree::PointTree(std::span<const Vec3f> points) {
  nodes_.reserve(points.size());
  for (std::uint32_t i = 0; i < points.size(); ++i) {
    if (is_finite(points[i])) nodes_.push_back({points[i], i, 0});
  }
  build(0, nodes_.size());
}

std::uint32_t PointTree::nearest(const Vec3f& to) const {
  Best best;
  search(0, nodes_.size(), to, best);
  return best.index;
}

void PointTree::build(std::size_t begin, std::size_t end) {
  if (end - begin < 2) return;
  Vec3f lo = nodes_[begin].point, hi = lo;
  for (std::size_t i = begin; i < end; ++i) {
    for (int axis = 0; axis < 3; ++axis) {
      lo[axis] = std::min(lo[axis], nodes_[i].point[axis]);
      hi[axis] = std::max(hi[axis], nodes_[i].point[axis]);
    }
  }
  const Vec3f size = hi - lo;
  const int axis = size.x >= std::max(size.y, size.z) ? 0 : (size.y >= size.z ? 1 : 2);
  const std::size_t middle = begin + (end - begin) / 2;
  std::nth_element(nodes_.begin() + std::ptrdiff_t(begin), nodes_.begin() + std::ptrdiff_t(middle),
                   nodes_.begin() + std::ptrdiff_t(end),
                   [axis](const Node& a, const Node& b) { return a.point[axis] < b.point[axis]; });
  nodes_[middle].axis = axis;
  build(begin, middle);
  build(middle + 1, end);
}

void PointTree::search(std::size_t begin, std::size_t end, const Vec3f& to, Best& best) const {
  if (begin >= end) return;
  const std::size_t middle = begin + (end - begin) / 2;
  const Node& node = nodes_[middle];
  const float distance = length_squared(node.point - to);
  if (distance < best.distance_squared || (distance == best.distance_squared && node.index < best.index)) {
    best = {distance, node.index};
  }
  const float beyond = to[node.axis] - node.point[node.axis];
  const bool before = beyond <= 0;
  search(before ? begin : middle + 1, before ? middle : end, to, best);
  // Search the other side, which may contain an equally near point.
  if (beyond * beyond <= best.distance_squared)
    search(before ? middle + 1 : begin, before ? end : middle, to, best);
}

}  // namespace souple::render
