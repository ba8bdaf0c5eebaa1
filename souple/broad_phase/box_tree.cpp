#include "souple/broad_phase/box_tree.h"

#include <algorithm>

namespace souple {
namespace {

constexpr std::uint32_t leaf_size = 4;

}  // namespace

std::uint32_t BoxTree::split(std::uint32_t begin, std::uint32_t end) {
  const auto index = static_cast<std::uint32_t>(nodes_.size());
  nodes_.push_back({{}, begin, end, 0});
  if (end - begin <= leaf_size) return index;
  Bounds centers{center_[order_[begin]], center_[order_[begin]]};
  for (std::uint32_t k = begin; k < end; ++k)
    centers = united(centers, {center_[order_[k]], center_[order_[k]]});
  const Vec3f size = centers.hi - centers.lo;
  const int axis = size.x >= size.y && size.x >= size.z ? 0 : (size.y >= size.z ? 1 : 2);
  const std::uint32_t middle = begin + (end - begin) / 2;
  const auto at = [&](std::uint32_t k) { return order_.begin() + static_cast<std::ptrdiff_t>(k); };
  std::nth_element(at(begin), at(middle), at(end), [&](std::uint32_t a, std::uint32_t b) {
    return center_[a][axis] != center_[b][axis] ? center_[a][axis] < center_[b][axis] : a < b;
  });
  split(begin, middle);
  const std::uint32_t right = split(middle, end);
  nodes_[index].right = right;
  return index;
}

}  // namespace souple
