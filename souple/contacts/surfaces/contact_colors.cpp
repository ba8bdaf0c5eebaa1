#include "souple/contacts/surfaces/contact_colors.h"

#include "souple/assert.h"
#include "souple/broad_phase/spatial_hash.h"
#include "souple/state/bytes.h"

#include <algorithm>
#include <bit>
#include <limits>

namespace souple {
namespace {

constexpr std::uint32_t no_color = std::numeric_limits<std::uint32_t>::max();
constexpr std::size_t max_words = 16;  // of 64 colors each, per particle

}  // namespace

void ContactColors::set_count(std::size_t particles) {
  used_.reserve(3 * particles), first_free_.reserve(particles), next_.reserve(particles);
  colored_.reserve(particles);
  begin_.reserve(512), next_slot_.reserve(512);
}

void ContactColors::extend(std::size_t first_new, const ElementPairs& pairs) {
  const std::size_t old_size = first_new == 0 ? 0 : color_.size();
  resize_with_spare(color_, pairs.size());
  std::fill(color_.begin() + static_cast<std::ptrdiff_t>(old_size), color_.end(), no_color);
  if (first_new != 0) return;
  const std::size_t n = pairs.surfaces().particle_count();
  if (first_free_.size() == n) {
    for (const std::uint32_t i : colored_) forget(i);
  } else {
    first_free_.assign(n, 0), next_.assign(n, 0), used_.assign(n, 0);
  }
  colored_.clear();
}

void ContactColors::forget(std::size_t particle) {
  first_free_[particle] = next_[particle] = 0;
  for (std::size_t at = particle; at < used_.size(); at += first_free_.size()) used_[at] = 0;
}

void ContactColors::keep(std::span<const std::uint32_t> former) {
  for (std::size_t k = 0; k < former.size(); ++k) color_[k] = color_[former[k]];
  color_.resize(former.size());
}

void ContactColors::forget(std::span<const IndexRange> particles) {
  for (const IndexRange& range : particles)
    for (std::size_t i = range.begin; i < range.end; ++i) forget(i);
}

// The lowest color that none of its movable particles has.
std::uint32_t ContactColors::color_of(const NearPair& pair, const ParticleView& particles, std::size_t n) {
  std::size_t word = 0;
  for (const std::uint32_t i : pair.particle)
    if (particles.inverse_mass(i) > 0) word = std::max<std::size_t>(word, first_free_[i]);
  for (; word < max_words; ++word) {
    if (used_.size() == word * n) used_.resize(used_.size() + n, 0);
    std::uint64_t* const used = used_.data() + word * n;
    std::uint64_t occupied = 0;
    for (const std::uint32_t i : pair.particle)
      if (particles.inverse_mass(i) > 0) occupied |= used[i];
    if (occupied == ~std::uint64_t{0}) continue;
    const int bit = std::countr_one(occupied);
    for (const std::uint32_t i : pair.particle) {
      if (used[i] == 0) colored_.push_back(i);
      used[i] |= std::uint64_t{1} << bit;
      if (used[i] == ~std::uint64_t{0} && first_free_[i] == word) ++first_free_[i];
    }
    return static_cast<std::uint32_t>(64 * word + static_cast<std::size_t>(bit));
  }
  return next_color_of(pair, particles);
}

std::uint32_t ContactColors::next_color_of(const NearPair& pair, const ParticleView& particles) {
  std::uint32_t color = 64 * max_words;
  for (const std::uint32_t i : pair.particle)
    if (particles.inverse_mass(i) > 0) color = std::max(color, next_[i]);
  for (const std::uint32_t i : pair.particle) next_[i] = color + 1, colored_.push_back(i);
  return color;
}

void ContactColors::sort(std::span<const PairToi> contacts, const ElementPairs& pairs,
                         const ParticleView& particles) {
  next_slot_.assign(next_slot_.capacity() > 0 ? 2 : 256, 0);
  for (const PairToi& contact : contacts) {
    std::uint32_t& color = color_[contact.pair];
    if (color == no_color)
      color = color_of(pairs.pair(contact.pair), particles, pairs.surfaces().particle_count());
    const std::size_t kind = 2 * std::size_t{color} + (pairs.are_edges(contact.pair) ? 1 : 0);
    if (next_slot_.size() <= kind) next_slot_.resize(2 * std::size_t{color} + 2, 0);
    ++next_slot_[kind];
  }
  begin_.clear();
  std::size_t sum = 0;
  for (std::size_t kind = 0; kind < next_slot_.size(); kind += 2) {
    const std::size_t vertices = next_slot_[kind], edges = next_slot_[kind + 1];
    next_slot_[kind] = sum, next_slot_[kind + 1] = sum + vertices;
    if (vertices + edges == 0) continue;
    begin_.push_back(sum), begin_.push_back(sum + vertices);
    sum += vertices + edges;
  }
  begin_.push_back(sum);
  resize_with_spare(pair_, sum, contact_spare);
  resize_with_spare(toi_, sum, contact_spare);
  for (const PairToi& contact : contacts) {
    const std::size_t slot =
        next_slot_[2 * std::size_t{color_[contact.pair]} + (pairs.are_edges(contact.pair) ? 1 : 0)]++;
    pair_[slot] = contact.pair;
    toi_[slot] = contact.toi;
  }
  SOUPLE_ASSERT(std::is_sorted(begin_.begin(), begin_.end()), "colors follow each other");
  SOUPLE_ASSERT(are_independent(pairs, particles), "contacts of one color share no particle that moves");
}

bool ContactColors::are_independent(const ElementPairs& pairs, const ParticleView& particles) const {
  // Per particle: its last contact, counted from 1. Warm steps allocate nothing, with assertions too.
  thread_local std::vector<std::size_t> last;
  last.assign(pairs.surfaces().particle_count(), 0);
  for (std::size_t kind = 0; kind + 1 < begin_.size(); ++kind)
    for (std::size_t slot = begin_[kind]; slot < begin_[kind + 1]; ++slot)
      for (const std::uint32_t i : pairs.pair(pair_[slot]).particle) {
        if (!(particles.inverse_mass(i) > 0)) continue;
        if (last[i] > begin_[kind - kind % 2] && last[i] != slot + 1) return false;
        last[i] = slot + 1;
      }
  return true;
}

std::size_t ContactColors::bytes() const {
  return bytes_of(color_, used_, first_free_, next_, pair_, toi_);
}

}  // namespace souple
