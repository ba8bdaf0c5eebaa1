#pragma once

#include "souple/math/disjoint_sets.h"
#include "souple/rigid/contact_block.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace souple {

/// Groups of contacts that share no body which moves. Contacts of a large island have colors: those of one color share no
/// such body either.
class ContactIslands {
 public:
  struct Range {
    std::uint32_t begin = 0, end = 0;  ///< in order()
    std::uint32_t size() const { return end - begin; }
  };
  struct Island {
    Range contacts;
    Range colors;                              ///< in colors(); empty in a small island
    std::uint32_t lowest = ~std::uint32_t{0};  ///< of its bodies that move: names the island in all substeps
  };
  static constexpr std::uint32_t none = ~std::uint32_t{0};
  /// Islands with more contacts are large.
  static constexpr std::uint32_t small = 400;

  /// `bodies`: number of bodies.
  void find(std::span<const ContactBlock> blocks, std::size_t bodies);
  std::span<const Island> islands() const { return islands_; }
  /// The island of a body that moves; none if it has no contact.
  std::uint32_t of(std::uint32_t body) { return island_of_[connected_.root(body)]; }
  std::span<const std::uint32_t> contacts(const Range& range) const {
    return std::span(order_).subspan(range.begin, range.size());
  }
  std::span<const Range> colors(const Island& island) const {
    return std::span(colors_).subspan(island.colors.begin, island.colors.size());
  }
  std::size_t bytes() const;

 private:
  void color(Island& island, std::span<const ContactBlock> blocks);

  DisjointSets connected_;                     // bodies
  std::vector<std::uint32_t> island_of_;       // per body
  std::vector<std::uint64_t> taken_;           // per body: colors of its contacts
  std::vector<std::uint32_t> order_, sorted_;  // contacts, by island and color
  std::vector<std::uint8_t> color_;            // per contact
  std::vector<Island> islands_;
  std::vector<Range> colors_;
};

}  // namespace souple
