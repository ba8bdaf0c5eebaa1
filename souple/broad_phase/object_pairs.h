#pragma once

#include "souple/broad_phase/bounds.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <type_traits>
#include <utility>
#include <vector>

namespace souple {

/// Which objects are compared: f(a, b) for the indices of two objects, in any order; f(a, a): an object with itself.
/// Refers to a callable of the caller; owns and allocates nothing.
class ObjectFilter {
 public:
  template <class Function>
  requires(!std::is_same_v<std::remove_cvref_t<Function>, ObjectFilter>)
      ObjectFilter(const Function& function)  // NOLINT(google-explicit-constructor)
      : function_(&function), call_([](const void* f, std::uint32_t a, std::uint32_t b) -> bool {
          return (*static_cast<const Function*>(f))(a, b);
        }) {}

  bool operator()(std::uint32_t a, std::uint32_t b) const { return call_(function_, a, b); }

 private:
  const void* function_;
  bool (*call_)(const void*, std::uint32_t, std::uint32_t);
};

/// A set of pairs of objects, (a, b) being (b, a). Memory and time are those of the pairs, however many objects there
/// are. A hash table with linear probing; its order is hidden.
class ObjectPairs {
 public:
  void add(std::uint32_t a, std::uint32_t b);
  bool contains(std::uint32_t a, std::uint32_t b) const {
    return !slots_.empty() && slots_[slot_of(key(a, b))] != 0;
  }
  bool operator()(std::uint32_t a, std::uint32_t b) const { return contains(a, b); }
  /// Keeps the memory.
  void clear();
  bool empty() const { return count_ == 0; }
  std::size_t bytes() const { return slots_.capacity() * sizeof(slots_[0]); }

 private:
  // Never 0, which marks a free slot.
  static std::uint64_t key(std::uint32_t a, std::uint32_t b) {
    if (b < a) std::swap(a, b);
    return (std::uint64_t{a} << 32 | b) + 1;
  }
  std::size_t slot_of(std::uint64_t key) const;
  void grow();

  std::vector<std::uint64_t> slots_;  // their number is a power of two
  std::size_t count_ = 0;
};

/// Boxes of objects that overlap. Sorts and sweeps along the axis along which their centers vary most (Baraff 1992,
/// "Dynamic simulation of non-penetrating rigid bodies", section 9.3).
class BoxSweep {
 public:
  /// Replaces the pairs by those of all boxes that share a point, each once, lower index first. They are in an order that
  /// depends on the boxes alone. Repeated calls allocate nothing.
  std::span<const std::pair<std::uint32_t, std::uint32_t>> find(std::span<const Bounds> boxes);
  std::size_t bytes() const;

 private:
  std::vector<std::uint32_t> order_;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> found_;
};

}  // namespace souple
