#pragma once

#include "souple/contacts/surfaces/element_pairs.h"
#include "souple/solver/projector.h"

#include <cstdint>
#include <span>
#include <vector>

namespace souple {

/// Colors of surface contacts: those of one color share no particle that can move. The coloring is greedy, grows as new
/// pairs come into contact, and lasts until the next search of all pairs. A particle in thousands of contacts, of a
/// large triangle under a fine mesh, needs as many colors. From color 1024 on, a contact gets the next color of its
/// particles, so that time and memory stay in proportion to the contacts.
class ContactColors {
 public:
  ContactColors() { clear_contacts(); }
  void set_count(std::size_t particles);
  /// Pairs from `first_new` on are new and have no color; 0: all pairs are new.
  void extend(std::size_t first_new, const ElementPairs& pairs);
  /// Call after ElementPairs::drop_replaced.
  void keep(std::span<const std::uint32_t> former);
  /// All pairs of these particles are new.
  void forget(std::span<const IndexRange> particles);
  void clear_contacts() { begin_.assign(1, 0); }
  /// Sorts contacts by color; within a color vertices and triangles come first, then edges, each in the given order.
  void sort(std::span<const PairToi> contacts, const ElementPairs& pairs, const ParticleView& particles);

  /// Sorted contacts: index of the pair, time of impact.
  const std::vector<std::uint32_t>& pair() const { return pair_; }
  const std::vector<float>& toi() const { return toi_; }
  int count() const { return static_cast<int>((begin_.size() - 1) / 2); }
  /// Contacts of color c: vertices against triangles begin at begin()[2 c], edges at begin()[2 c + 1].
  std::span<const std::size_t> begin() const { return begin_; }
  std::size_t bytes() const;

 private:
  void forget(std::size_t particle);
  std::uint32_t color_of(const NearPair& pair, const ParticleView& particles, std::size_t particle_count);
  std::uint32_t next_color_of(const NearPair& pair, const ParticleView& particles);
  bool are_independent(const ElementPairs& pairs, const ParticleView& particles) const;

  /// Per pair that has made a contact since the last search of all pairs: its color. It keeps the color until
  /// the next such search.
  std::vector<std::uint32_t> color_;
  /// Bits of the colors that contacts of each particle have: a word of 64 colors for all particles, then the
  /// next 64.
  std::vector<std::uint64_t> used_;
  std::vector<std::uint32_t> first_free_;  // per particle: its first word of `used_` that is not full
  std::vector<std::uint32_t> next_;        // per particle: one more than its highest color from 1024 on
  std::vector<std::uint32_t> colored_;     // particles with a color, some more than once
  std::vector<std::uint32_t> pair_;
  std::vector<float> toi_;
  std::vector<std::size_t> begin_, next_slot_;
};

}  // namespace souple
