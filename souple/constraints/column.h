#pragma once

#include "souple/math/bit_cast.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace souple {

/// One number per constraint. As long as all numbers are equal, only one is stored.
class Column {
 public:
  std::size_t size() const { return size_; }
  float operator[](std::size_t i) const { return values_[i * stride()]; }
  /// Distance in `data` between the values of neighboring constraints: 0 while all values are equal, else 1.
  std::size_t stride() const { return uniform_ ? 0 : 1; }
  const float* data() const { return values_.data(); }
  /// Number of values in `data`.
  std::size_t distinct() const { return values_.size(); }
  std::size_t bytes() const { return values_.capacity() * sizeof(float); }

  void push_back(float value) {
    if (size_ == 0) values_.assign(1, value), uniform_ = true;
    if (uniform_ && !same(value)) expand();
    if (!uniform_) values_.push_back(value);
    ++size_;
  }
  /// Adds values [begin, end) of another column.
  void append(const Column& from, std::size_t begin, std::size_t end) {
    if (begin == end) return;
    if (from.uniform_ && (size_ == 0 || (uniform_ && same(from.values_[0])))) {
      if (size_ == 0) values_.assign(1, from.values_[0]), uniform_ = true;
      size_ += end - begin;
      return;
    }
    while (begin < end && (uniform_ || from.uniform_)) push_back(from[begin++]);
    values_.insert(values_.end(), from.values_.begin() + static_cast<std::ptrdiff_t>(begin < end ? begin : 0),
                   from.values_.begin() + static_cast<std::ptrdiff_t>(begin < end ? end : 0));
    size_ += end - begin;
  }
  void set(std::size_t i, float value) {
    if (uniform_ && same(value)) return;
    if (uniform_) expand();
    values_[i] = value;
  }
  /// Makes value order[k] the k-th; removes values that `order` omits.
  void reorder(std::span<const std::uint32_t> order) {
    size_ = order.size();
    if (uniform_) return;
    std::vector<float> sorted;
    sorted.reserve(order.size());
    for (const std::uint32_t i : order) sorted.push_back(values_[i]);
    values_ = std::move(sorted);
  }
  void shrink_to_fit() { values_.shrink_to_fit(); }

 private:
  // Compares bits: 0 and -0 differ.
  bool same(float value) const {
    return bit_cast<std::uint32_t>(value) == bit_cast<std::uint32_t>(values_[0]);
  }
  void expand() {
    values_.resize(size_, values_[0]);
    uniform_ = false;
  }

  std::vector<float> values_;
  std::size_t size_ = 0;
  bool uniform_ = true;
};

}  // namespace souple
