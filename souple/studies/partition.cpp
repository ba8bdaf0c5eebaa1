#include "souple/studies/partition.h"

#include "souple/assert.h"
#include "souple/solver/facets.h"

#include <algorithm>
#include <numeric>
#include <utility>

namespace souple {
namespace {

/// The constraints of each particle, counted by color. A particle that has n constraints of one color needs n
/// copies. n copies are enough: constraints are assigned to them in turn, color after color, so no copy gets
/// two of one color.
class Copies {
 public:
  Copies(std::size_t particle_count, std::size_t colors)
      : colors_(colors), count_(particle_count * colors), copies_(particle_count, 1) {}

  /// Cost of another constraint of this color on these particles: new copies, then the number of constraints
  /// of this color that the particles have already.
  using Cost = std::pair<std::uint32_t, std::uint32_t>;
  Cost cost(std::span<const std::uint32_t> particles, std::size_t color) const {
    std::uint32_t copies = 0, conflicts = 0;
    for (const std::uint32_t particle : particles) {
      const std::uint32_t here = count_[particle * colors_ + color];
      copies += here >= copies_[particle] ? 1 : 0;
      conflicts += here;
    }
    return {copies, conflicts};
  }
  void add(std::span<const std::uint32_t> particles, std::size_t color) {
    for (const std::uint32_t particle : particles)
      copies_[particle] = std::max(copies_[particle], ++count_[particle * colors_ + color]);
  }
  const std::vector<std::uint32_t>& of_particle() const { return copies_; }

 private:
  std::size_t colors_;
  std::vector<std::uint32_t> count_, copies_;
};

// Keeps the first `colors` colors, which need no phantom, and assigns the constraints of the other colors
// where they cost least. Returns the color of each constraint.
std::vector<std::uint32_t> assign_colors(std::span<const std::uint32_t> color_begin,
                                         std::span<const std::uint32_t> indices, std::size_t arity,
                                         std::size_t colors, Copies& copies) {
  std::vector<std::uint32_t> color_of(indices.size() / arity);
  const auto assign = [&](std::size_t i, std::size_t color) {
    copies.add(indices.subspan(i * arity, arity), color);
    color_of[i] = static_cast<std::uint32_t>(color);
  };
  for (std::size_t color = 0; color < colors; ++color)
    for (std::size_t i = color_begin[color]; i < color_begin[color + 1]; ++i) assign(i, color);
  for (std::size_t i = color_begin[colors]; i < color_of.size(); ++i) {
    const auto particles = indices.subspan(i * arity, arity);
    std::size_t best = 0;
    for (std::size_t color = 1; color < colors; ++color)
      if (copies.cost(particles, color) < copies.cost(particles, best)) best = color;
    assign(i, best);
  }
  return color_of;
}

}  // namespace

Partition partition_constraints(std::span<const std::uint32_t> indices, int arity, std::size_t particle_count,
                                std::span<const std::uint32_t> color_begin, int colors,
                                std::uint32_t first_phantom) {
  const auto width = static_cast<std::size_t>(arity);
  const auto limit = static_cast<std::size_t>(colors);
  Partition result;
  if (color_begin.size() <= limit + 1) {
    result.coloring.color_begin.assign(color_begin.begin(), color_begin.end());
    result.coloring.order.resize(indices.size() / width);
    std::iota(result.coloring.order.begin(), result.coloring.order.end(), 0u);
    result.indices.assign(indices.begin(), indices.end());
    return result;
  }
  Copies copies(particle_count, limit);
  result.coloring = sorted_by_color(indices, arity, particle_count,
                                    assign_colors(color_begin, indices, width, limit, copies));
  std::vector<std::uint32_t> first(particle_count), next_phantom(particle_count);
  for (std::uint32_t particle = 0; particle < particle_count; ++particle) {
    const std::uint32_t count = copies.of_particle()[particle];
    const auto phantoms = static_cast<std::uint32_t>(result.phantom_of.size());
    first[particle] = count == 1 ? particle : first_phantom + phantoms;
    if (count > 1) result.phantom_of.insert(result.phantom_of.end(), count, particle);
  }
  result.indices.reserve(indices.size());
  for (const std::uint32_t i : result.coloring.order)
    for (const std::uint32_t particle : indices.subspan(i * width, width))
      result.indices.push_back(first[particle] + next_phantom[particle]++ % copies.of_particle()[particle]);
  SOUPLE_ASSERT(are_independent(result.indices, arity, result.coloring.color_begin),
                "constraints of one color share no phantom and no unsplit particle");
  return result;
}

std::vector<std::uint32_t> split(Projector& projector, int colors, std::uint32_t first_phantom) {
  StudyFacet* const set = projector.facets().study;
  if (set == nullptr || projector.color_count() <= colors) return {};
  const std::vector<std::uint32_t> indices = set->indices();
  const std::size_t particles = *std::max_element(indices.begin(), indices.end()) + std::size_t{1};
  Partition partition =
      partition_constraints(indices, set->arity(), particles, set->color_begin(), colors, first_phantom);
  set->replace(std::move(partition.coloring), partition.indices);
  return std::move(partition.phantom_of);
}

}  // namespace souple
