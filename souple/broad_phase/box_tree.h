#pragma once

#include "souple/assert.h"
#include "souple/broad_phase/bounds.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

namespace souple {

/// Bounding volume hierarchy of elements that move. Nodes are split at the median of the boxes' centers along the longest
/// side. While the number of elements stays, moved boxes refit the tree; once its nodes have grown to twice their area,
/// the tree is built again. The results of a search do not depend on the shape of the tree.
class BoxTree {
 public:
  /// Elements 0 to count - 1 now have the boxes box_of(i), which must be finite. Allocates nothing while `count` stays.
  template <class BoxOf>
  void update(std::size_t count, const BoxOf& box_of) {
    if (count == order_.size()) {
      refit(box_of);
      if (area_ <= 2 * built_area_) return;
    }
    build(count, box_of);
    refit(box_of);
    built_area_ = area_;
  }

  bool empty() const { return nodes_.empty(); }
  /// Around all elements; the tree must not be empty.
  const Bounds& bounds() const { return nodes_.front().box; }

  /// Calls visit(element) for the elements that may be within limit(), nearest box first. bound(box) is a lower bound of
  /// whatever the caller minimizes, infinity for a box to skip; limit() may decrease as elements are visited.
  template <class Bound, class Limit, class Visit>
  void search(const Bound& bound, const Limit& limit, const Visit& visit) const {
    if (nodes_.empty()) return;
    std::array<std::pair<std::uint32_t, double>, 64> stack;
    std::size_t depth = 0;
    const auto push = [&](std::uint32_t n, double at) {
      SOUPLE_ASSERT(depth < stack.size(), "the tree is balanced");
      if (at < infinity && at <= limit()) stack[depth++] = {n, at};
    };
    push(0, bound(nodes_[0].box));
    while (depth > 0) {
      const auto [n, at] = stack[--depth];
      if (at > limit()) continue;
      const Node& node = nodes_[n];
      if (node.right == 0) {
        for (std::uint32_t k = node.begin; k < node.end; ++k) visit(order_[k]);
        continue;
      }
      const double left = bound(nodes_[n + 1].box), right = bound(nodes_[node.right].box);
      if (left <= right) {
        push(node.right, right), push(n + 1, left);
      } else {
        push(n + 1, left), push(node.right, right);
      }
    }
  }

  std::size_t bytes() const {
    return nodes_.capacity() * sizeof(Node) +
           (order_.capacity() + center_.capacity() * 3) * sizeof(std::uint32_t);
  }

 private:
  static constexpr double infinity = std::numeric_limits<double>::infinity();
  struct Node {
    Bounds box;
    std::uint32_t begin = 0, end = 0;  // of order_
    std::uint32_t right = 0;  // index of the right child, 0 for a leaf; the left child is the next node
  };

  template <class BoxOf>
  void build(std::size_t count, const BoxOf& box_of) {
    center_.resize(count);
    order_.resize(count);
    for (std::uint32_t i = 0; i < count; ++i) {
      const Bounds box = box_of(i);
      center_[i] = box.lo + box.hi;
      order_[i] = i;
    }
    nodes_.clear();
    if (count > 0) split(0, static_cast<std::uint32_t>(count));
  }
  // Children come after their parent.
  template <class BoxOf>
  void refit(const BoxOf& box_of) {
    area_ = 0;
    for (std::size_t n = nodes_.size(); n-- > 0;) {
      Node& node = nodes_[n];
      if (node.right == 0) {
        node.box = box_of(order_[node.begin]);
        for (std::uint32_t k = node.begin + 1; k < node.end; ++k)
          node.box = united(node.box, box_of(order_[k]));
      } else {
        node.box = united(nodes_[n + 1].box, nodes_[node.right].box);
      }
      const Vec3f size = node.box.hi - node.box.lo;
      area_ += static_cast<double>(size.x * size.y + size.y * size.z + size.z * size.x);
    }
  }
  std::uint32_t split(std::uint32_t begin, std::uint32_t end);

  std::vector<Node> nodes_;
  std::vector<std::uint32_t> order_;  // elements in the order of the leaves
  std::vector<Vec3f> center_;         // per element: twice its box's center when the tree was built [m]
  double area_ = 0, built_area_ = 0;  // half the area of all nodes [m^2]
};

}  // namespace souple
