#include "souple/solver/colouring.h"

#include <algorithm>
#include <numeric>

namespace souple {
namespace {

constexpr std::uint32_t uncoloured = ~std::uint32_t{0};
constexpr int colours_per_round = 64;

// Gives each constraint of `pending` a colour in [first, first + 64) that its particles do not have yet;
// returns those that found none.
std::vector<std::uint32_t> colour_round(std::span<const std::uint32_t> indices, std::size_t arity,
                                        std::span<const std::uint32_t> pending, std::uint32_t first,
                                        std::vector<std::uint64_t>& taken,
                                        std::vector<std::uint32_t>& colour_of) {
  std::vector<std::uint32_t> left;
  for (const std::uint32_t constraint : pending) {
    const auto particles = indices.subspan(constraint * arity, arity);
    std::uint64_t used = 0;
    for (const std::uint32_t particle : particles) used |= taken[particle];
    if (~used == 0) {
      left.push_back(constraint);
      continue;
    }
    std::uint32_t colour = 0;
    while ((used >> colour) & 1u) ++colour;
    colour_of[constraint] = first + colour;
    for (const std::uint32_t particle : particles) taken[particle] |= std::uint64_t{1} << colour;
  }
  return left;
}

}  // namespace

Colouring colour_constraints(std::span<const std::uint32_t> indices, int arity, std::size_t particle_count) {
  const auto width = static_cast<std::size_t>(arity);
  const std::size_t count = indices.size() / width;
  std::vector<std::uint32_t> colour_of(count, uncoloured);
  std::vector<std::uint32_t> pending(count);
  std::iota(pending.begin(), pending.end(), 0u);
  std::vector<std::uint64_t> taken(particle_count);
  for (std::uint32_t first = 0; !pending.empty(); first += colours_per_round) {
    std::fill(taken.begin(), taken.end(), 0);
    pending = colour_round(indices, width, pending, first, taken, colour_of);
  }

  // Counting sort by colour, stable; colours that stayed empty (the end of a round) are skipped.
  std::vector<std::uint32_t> size_of;
  for (const std::uint32_t colour : colour_of) {
    if (colour >= size_of.size()) size_of.resize(colour + 1, 0);
    ++size_of[colour];
  }
  Colouring result;
  std::vector<std::uint32_t> next(size_of.size());
  std::uint32_t begin = 0;
  for (std::size_t colour = 0; colour < size_of.size(); ++colour) {
    if (size_of[colour] > 0) result.colour_begin.push_back(begin);
    next[colour] = begin;
    begin += size_of[colour];
  }
  result.colour_begin.push_back(begin);
  result.order.resize(count);
  for (std::uint32_t i = 0; i < count; ++i) result.order[next[colour_of[i]]++] = i;
  return result;
}

}  // namespace souple
