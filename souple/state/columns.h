#pragma once

#include <array>
#include <cstddef>
#include <cstring>
#include <type_traits>
#include <utility>
#include <vector>

namespace souple {

/// Rows of values as columns (structure of arrays), the layout that kernels read and write. `Columns` consists of pointers:
/// each is the begin of one column, whose values have four bytes.
template <class Columns>
class ColumnStore {
 public:
  /// Part of the size that is reserved beyond it: the number of contacts changes fast.
  static constexpr double spare = 1;
  std::size_t size() const { return size_; }
  /// Existing rows keep their values, further ones have any. A size that was reached before allocates nothing.
  void resize(std::size_t size) {
    if (size > capacity_) reallocate(size);
    size_ = size;
  }
  /// Copies the values of a row to another row.
  void copy(std::size_t from, std::size_t to) {
    for (std::size_t c = 0; c < count; ++c)
      std::memmove(memory_.data() + (c * capacity_ + to) * value,
                   memory_.data() + (c * capacity_ + from) * value, value);
  }
  /// They are valid until `resize` needs memory.
  Columns columns() const {
    std::array<std::byte*, count> begins;
    for (std::size_t c = 0; c < count; ++c)
      begins[c] = const_cast<std::byte*>(memory_.data()) + c * capacity_ * value;
    Columns result;
    std::memcpy(static_cast<void*>(&result), begins.data(), sizeof result);
    return result;
  }
  std::size_t bytes() const { return capacity_ * value * count; }

 private:
  static constexpr std::size_t value = 4, line = 64 / value, count = sizeof(Columns) / sizeof(void*);
  static_assert(std::is_trivially_copyable_v<Columns> && sizeof(Columns) == count * sizeof(void*));

  // An odd number of cache lines: columns that began at equal addresses modulo 4096 would share few lines of the cache.
  void reallocate(std::size_t size) {
    const std::size_t capacity =
        line * (static_cast<std::size_t>((1 + spare) * double(size)) / line | 1) + 2 * line;
    std::vector<std::byte> memory(capacity * value * count);
    for (std::size_t c = 0; size_ > 0 && c < count; ++c)
      std::memcpy(memory.data() + c * capacity * value, memory_.data() + c * capacity_ * value,
                  size_ * value);
    memory_ = std::move(memory), capacity_ = capacity;
  }

  std::vector<std::byte> memory_;
  std::size_t size_ = 0, capacity_ = 0;
};

}  // namespace souple
