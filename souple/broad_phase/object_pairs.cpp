#include "souple/broad_phase/object_pairs.h"

#include "souple/math/sentinels.h"
#include "souple/state/bytes.h"

#include <algorithm>
#include <numeric>

namespace souple {
namespace {

// A lower corner that is not a number comes first: sorting needs an order of all boxes.
float begin_of(const Bounds& box, int axis) {
  return box.lo[axis] > -infinity ? box.lo[axis] : -infinity;
}

/// The axis along which the centers of the valid boxes vary most.
int widest_axis(std::span<const Bounds> boxes) {
  double count = 0;
  Vec3d sum, squares;
  for (const Bounds& box : boxes) {
    if (!is_finite(box)) continue;
    const Vec3d center = Vec3d(box.lo) + Vec3d(box.hi);
    ++count, sum += center;
    for (int axis = 0; axis < 3; ++axis) squares[axis] += center[axis] * center[axis];
  }
  int widest = 0;
  const auto variance = [&](int axis) { return squares[axis] - sum[axis] * sum[axis] / max(count, 1.0); };
  for (int axis = 1; axis < 3; ++axis)
    if (variance(axis) > variance(widest)) widest = axis;
  return widest;
}

}  // namespace

std::size_t ObjectPairs::slot_of(std::uint64_t key) const {
  // Fibonacci hashing: the upper bits of a product with 2^64 / golden ratio.
  const std::size_t last = slots_.size() - 1;
  std::size_t slot = static_cast<std::size_t>((key * 0x9e3779b97f4a7c15u) >> 32) & last;
  while (slots_[slot] != 0 && slots_[slot] != key) slot = (slot + 1) & last;
  return slot;
}

void ObjectPairs::grow() {
  std::vector<std::uint64_t> old = std::exchange(slots_, {});
  slots_.assign(std::max<std::size_t>(64, 2 * old.size()), 0);
  for (const std::uint64_t key : old)
    if (key != 0) slots_[slot_of(key)] = key;
}

void ObjectPairs::add(std::uint32_t a, std::uint32_t b) {
  if (2 * (count_ + 1) > slots_.size()) grow();
  std::uint64_t& slot = slots_[slot_of(key(a, b))];
  count_ += slot == 0 ? 1 : 0;
  slot = key(a, b);
}

void ObjectPairs::clear() {
  if (count_ > 0) std::fill(slots_.begin(), slots_.end(), 0u);
  count_ = 0;
}

std::span<const std::pair<std::uint32_t, std::uint32_t>> BoxSweep::find(std::span<const Bounds> boxes) {
  found_.clear();
  const int axis = widest_axis(boxes);
  order_.resize(boxes.size());
  std::iota(order_.begin(), order_.end(), 0u);
  std::sort(order_.begin(), order_.end(), [&](std::uint32_t a, std::uint32_t b) {
    return std::pair(begin_of(boxes[a], axis), a) < std::pair(begin_of(boxes[b], axis), b);
  });
  for (std::size_t k = 0; k < order_.size(); ++k) {
    const std::uint32_t a = order_[k];
    for (std::size_t j = k + 1; j < order_.size(); ++j) {
      const std::uint32_t b = order_[j];
      if (begin_of(boxes[b], axis) > boxes[a].hi[axis]) break;
      if (overlap(boxes[a], boxes[b])) found_.emplace_back(std::min(a, b), std::max(a, b));
    }
  }
  return found_;
}

std::size_t BoxSweep::bytes() const {
  return bytes_of(order_, found_);
}

}  // namespace souple
