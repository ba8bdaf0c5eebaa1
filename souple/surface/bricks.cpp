#include "souple/surface/bricks.h"

#include <algorithm>
#include <utility>

namespace souple {

namespace {

constexpr std::uint64_t free_key = ~std::uint64_t{0};
constexpr int brick_bits = 21;

}  // namespace

void Bricks::clear() {
  if (slots_.empty()) slots_.resize(1024);
  std::fill(slots_.begin(), slots_.end(), Slot{free_key, none, 0});
  used_ = 0;
  keys_.clear();
  marked_.clear();
}

std::uint64_t Bricks::key_of(const Coordinates& at) {
  const auto part = [](std::int32_t c) { return static_cast<std::uint64_t>(c + limit); };
  return (part(at[2]) << brick_bits | part(at[1])) << brick_bits | part(at[0]);
}

// Open addressing: the slot of the key, or the free slot for it.
std::size_t Bricks::slot_of(std::uint64_t key) const {
  const std::size_t last = slots_.size() - 1;
  std::size_t slot = static_cast<std::size_t>(key * 0x9e3779b97f4a7c15u >> 20) & last;
  while (slots_[slot].key != key && slots_[slot].key != free_key) slot = (slot + 1) & last;
  return slot;
}

void Bricks::grow() {
  std::vector<Slot> old(2 * slots_.size(), Slot{free_key, none, 0});
  std::swap(old, slots_);
  for (const Slot& slot : old)
    if (slot.key != free_key) slots_[slot_of(slot.key)] = slot;
}

void Bricks::add(const Coordinates& at, bool marked) {
  const std::uint64_t key = key_of(at);
  std::size_t slot = slot_of(key);
  if (slots_[slot].key == free_key) {
    if (2 * ++used_ > slots_.size()) {
      grow();
      slot = slot_of(key);
    }
    slots_[slot].key = key;
    keys_.push_back(key);
  }
  slots_[slot].marked |= marked ? 1 : 0;
}

void Bricks::sort() {
  std::sort(keys_.begin(), keys_.end());
  marked_.resize(keys_.size());
  for (std::size_t b = 0; b < keys_.size(); ++b) {
    Slot& slot = slots_[slot_of(keys_[b])];
    slot.brick = static_cast<std::uint32_t>(b);
    marked_[b] = static_cast<std::uint8_t>(slot.marked);
  }
}

Bricks::Coordinates Bricks::at(std::size_t brick) const {
  constexpr std::uint64_t mask = (std::uint64_t{1} << brick_bits) - 1;
  const auto part = [&](int shift) {
    return static_cast<std::int32_t>(keys_[brick] >> shift & mask) - limit;
  };
  return {part(0), part(brick_bits), part(2 * brick_bits)};
}

std::uint32_t Bricks::find(const Coordinates& at) const {
  const Slot& slot = slots_[slot_of(key_of(at))];
  return slot.key == free_key ? none : slot.brick;
}

}  // namespace souple
