#pragma once

#include <cstddef>
#include <cstdint>
#include <numeric>
#include <span>
#include <utility>
#include <vector>

namespace souple {

/// Lists of items, one for each key below a count, one after another in memory.
template <class Item>
class Lists {
 public:
  Lists() = default;
  template <class ForEach>
  Lists(std::size_t count, const ForEach& for_each) {
    fill(count, for_each);
  }
  /// Replaces the lists by a counting sort: for_each(add) calls add(key, item) for each item, twice the same. A list keeps
  /// the order of its items. A size that was reached before allocates nothing.
  template <class ForEach>
  void fill(std::size_t count, const ForEach& for_each) {
    begin_.assign(count + 2, 0);
    for_each([this](std::size_t key, const Item&) { ++begin_[key + 2]; });
    std::partial_sum(begin_.begin(), begin_.end(), begin_.begin());
    items_.resize(begin_.back());
    for_each([this](std::size_t key, const Item& item) { items_[begin_[key + 1]++] = item; });
    begin_.pop_back();
  }

  std::size_t size() const { return begin_.size() - 1; }
  std::span<const Item> operator[](std::size_t key) const {
    return {items_.data() + begin_[key], items_.data() + begin_[key + 1]};
  }
  std::span<Item> operator[](std::size_t key) {
    return {items_.data() + begin_[key], items_.data() + begin_[key + 1]};
  }
  /// All items, list after list.
  std::vector<Item> items() && { return std::move(items_); }
  std::size_t bytes() const {
    return begin_.capacity() * sizeof(begin_[0]) + items_.capacity() * sizeof(Item);
  }

 private:
  std::vector<std::uint32_t> begin_{0};  // per key, and the end of the last list
  std::vector<Item> items_;
};

}  // namespace souple
