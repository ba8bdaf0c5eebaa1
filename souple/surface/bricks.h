#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace souple {

/// A sparse set of bricks of an infinite grid, in order of z, then y, then x, with lookup by coordinates.
class Bricks {
 public:
  static constexpr std::uint32_t none = 0xffffffff;
  /// Coordinates are in [-limit, limit).
  static constexpr std::int32_t limit = 1 << 20;

  using Coordinates = std::array<std::int32_t, 3>;

  void clear();
  /// Adds a brick unless it exists, and marks it if `marked`.
  void add(const Coordinates& at, bool marked);
  /// Sorts the bricks: call it once after all add().
  void sort();

  std::size_t size() const { return keys_.size(); }
  Coordinates at(std::size_t brick) const;
  bool marked(std::size_t brick) const { return marked_[brick] != 0; }
  /// The brick's index, or none.
  std::uint32_t find(const Coordinates& at) const;

 private:
  // Slot of a hash table with open addressing. It serves lookup only; results do not depend on its order.
  struct Slot {
    std::uint64_t key;
    std::uint32_t brick;
    std::uint32_t marked;
  };
  static std::uint64_t key_of(const Coordinates& at);
  std::size_t slot_of(std::uint64_t key) const;
  void grow();

  std::vector<Slot> slots_;
  std::size_t used_ = 0;
  std::vector<std::uint64_t> keys_;
  std::vector<std::uint8_t> marked_;
};

}  // namespace souple
