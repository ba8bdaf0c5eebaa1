#include "souple/solver/partition.h"

#include <algorithm>
#include <numeric>
#include <utility>

namespace souple {
namespace {

/// The constraints of each particle, counted by colour. A particle that has n of one colour needs n copies,
/// and n are enough: dealt out in turn, colour after colour, no copy gets two of the same colour.
class Copies {
 public:
  Copies(std::size_t particle_count, std::size_t colours)
      : colours_(colours), count_(particle_count * colours), copies_(particle_count, 1) {}

  /// What a further constraint on these particles costs in that colour: copies, then how many constraints its
  /// particles have of that colour already.
  using Price = std::pair<std::uint32_t, std::uint32_t>;
  Price price(std::span<const std::uint32_t> particles, std::size_t colour) const {
    std::uint32_t copies = 0, rivals = 0;
    for (const std::uint32_t particle : particles) {
      const std::uint32_t here = count_[particle * colours_ + colour];
      copies += here >= copies_[particle] ? 1 : 0;
      rivals += here;
    }
    return {copies, rivals};
  }
  void add(std::span<const std::uint32_t> particles, std::size_t colour) {
    for (const std::uint32_t particle : particles)
      copies_[particle] = std::max(copies_[particle], ++count_[particle * colours_ + colour]);
  }
  const std::vector<std::uint32_t>& of_particle() const { return copies_; }

 private:
  std::size_t colours_;
  std::vector<std::uint32_t> count_, copies_;
};

// Keeps the first colours, which need no phantom, and puts the constraints of the others where they cost
// least. Returns the colour of each constraint.
std::vector<std::uint32_t> spread(std::span<const std::uint32_t> colour_begin,
                                  std::span<const std::uint32_t> indices, std::size_t arity,
                                  std::size_t colours, Copies& copies) {
  std::vector<std::uint32_t> colour_of(indices.size() / arity);
  const auto place = [&](std::size_t i, std::size_t colour) {
    copies.add(indices.subspan(i * arity, arity), colour);
    colour_of[i] = static_cast<std::uint32_t>(colour);
  };
  for (std::size_t colour = 0; colour < colours; ++colour)
    for (std::size_t i = colour_begin[colour]; i < colour_begin[colour + 1]; ++i) place(i, colour);
  for (std::size_t i = colour_begin[colours]; i < colour_of.size(); ++i) {
    const auto particles = indices.subspan(i * arity, arity);
    std::size_t best = 0;
    for (std::size_t colour = 1; colour < colours; ++colour)
      if (copies.price(particles, colour) < copies.price(particles, best)) best = colour;
    place(i, best);
  }
  return colour_of;
}

}  // namespace

Partition partition_constraints(std::span<const std::uint32_t> indices, int arity, std::size_t particle_count,
                                std::span<const std::uint32_t> colour_begin, int colours,
                                std::uint32_t first_phantom) {
  const auto width = static_cast<std::size_t>(arity);
  const auto limit = static_cast<std::size_t>(colours);
  Partition result;
  if (colour_begin.size() <= limit + 1) {
    result.colouring.colour_begin.assign(colour_begin.begin(), colour_begin.end());
    result.colouring.order.resize(indices.size() / width);
    std::iota(result.colouring.order.begin(), result.colouring.order.end(), 0u);
    result.indices.assign(indices.begin(), indices.end());
    return result;
  }
  Copies copies(particle_count, limit);
  result.colouring =
      sorted_by_colour(indices, arity, particle_count, spread(colour_begin, indices, width, limit, copies));
  std::vector<std::uint32_t> first(particle_count), turn(particle_count);
  for (std::uint32_t particle = 0; particle < particle_count; ++particle) {
    const std::uint32_t count = copies.of_particle()[particle];
    const auto phantoms = static_cast<std::uint32_t>(result.phantom_of.size());
    first[particle] = count == 1 ? particle : first_phantom + phantoms;
    if (count > 1) result.phantom_of.insert(result.phantom_of.end(), count, particle);
  }
  result.indices.reserve(indices.size());
  for (const std::uint32_t i : result.colouring.order)
    for (const std::uint32_t particle : indices.subspan(i * width, width))
      result.indices.push_back(first[particle] + turn[particle]++ % copies.of_particle()[particle]);
  return result;
}

}  // namespace souple
