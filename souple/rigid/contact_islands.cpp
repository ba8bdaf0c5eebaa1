#include "souple/rigid/contact_islands.h"

#include "souple/state/bytes.h"

#include <algorithm>
#include <array>
#include <bit>

namespace souple {

void ContactIslands::find(std::span<const ContactBlock> blocks, std::size_t bodies) {
  connected_.reset(bodies);
  for (const ContactBlock& block : blocks)
    if (block.moves_a && block.moves_b) connected_.join(block.a, block.b);
  island_of_.assign(bodies, none);
  islands_.clear(), colors_.clear();
  const auto island_at = [&](const ContactBlock& block) -> std::uint32_t& {
    return island_of_[connected_.root(block.moves_a ? block.a : block.b)];
  };
  for (const ContactBlock& block : blocks) {
    std::uint32_t& island = island_at(block);
    if (island == none) island = static_cast<std::uint32_t>(islands_.size()), islands_.emplace_back();
    ++islands_[island].contacts.end;
    std::uint32_t& lowest = islands_[island].lowest;
    if (block.moves_a) lowest = std::min(lowest, block.a);
    if (block.moves_b) lowest = std::min(lowest, block.b);
  }
  std::uint32_t begin = 0;
  for (Island& island : islands_) {
    begin += island.contacts.end;
    island.contacts = {begin - island.contacts.end, begin - island.contacts.end};
  }
  order_.resize(blocks.size()), sorted_.resize(blocks.size()), color_.resize(blocks.size());
  for (std::uint32_t c = 0; c < blocks.size(); ++c) order_[islands_[island_at(blocks[c])].contacts.end++] = c;
  taken_.assign(bodies, 0);
  for (Island& island : islands_)
    if (island.contacts.size() > small) color(island, blocks);
}

// In the order of contacts, each takes the first color that no earlier one of its bodies has. The last color may hold
// contacts that share a body.
void ContactIslands::color(Island& island, std::span<const ContactBlock> blocks) {
  constexpr std::uint32_t most = 63;
  const auto [begin, end] = island.contacts;
  std::array<std::uint32_t, most + 2> first{};
  for (std::uint32_t k = begin; k < end; ++k) {
    const ContactBlock& block = blocks[order_[k]];
    const std::uint64_t taken = (block.moves_a ? taken_[block.a] : 0) | (block.moves_b ? taken_[block.b] : 0);
    const std::uint32_t color = std::min(static_cast<std::uint32_t>(std::countr_one(taken)), most);
    if (block.moves_a) taken_[block.a] |= std::uint64_t{1} << color;
    if (block.moves_b) taken_[block.b] |= std::uint64_t{1} << color;
    color_[k] = static_cast<std::uint8_t>(color);
    ++first[color + 1];
  }
  for (std::uint32_t c = 0; c <= most; ++c) first[c + 1] += first[c];
  island.colors.begin = static_cast<std::uint32_t>(colors_.size());
  for (std::uint32_t c = 0; c <= most; ++c)
    if (first[c] < first[c + 1]) colors_.push_back({begin + first[c], begin + first[c + 1]});
  island.colors.end = static_cast<std::uint32_t>(colors_.size());
  for (std::uint32_t k = begin; k < end; ++k) sorted_[begin + first[color_[k]]++] = order_[k];
  std::copy(sorted_.data() + begin, sorted_.data() + end, order_.data() + begin);
}

std::size_t ContactIslands::bytes() const {
  return bytes_of(island_of_, taken_, order_, sorted_, color_, islands_, colors_) + connected_.bytes();
}

}  // namespace souple
