#include "souple/solver/particle_groups.h"

#include "souple/assert.h"
#include "souple/error.h"

#include <algorithm>
#include <string>

#include <fmt/core.h>

namespace souple {

void ParticleGroups::add(std::span<const std::uint32_t> particles, std::string_view what) {
  if (particles.empty())
    throw Error(std::string(what) + " has no particles, expected one or more: name the particles it acts on");
  std::vector<std::uint32_t> sorted(particles.begin(), particles.end());
  std::sort(sorted.begin(), sorted.end());
  const auto twice = std::adjacent_find(sorted.begin(), sorted.end());
  if (twice != sorted.end())
    throw Error(fmt::format("{} names particle {} twice, expected every particle once: remove the repetition",
                            what, *twice));
  particles_.insert(particles_.end(), particles.begin(), particles.end());
  begin_.push_back(static_cast<std::uint32_t>(particles_.size()));
  dirty_ = true;
}

void ParticleGroups::prepare(std::size_t particle_count, std::string_view what) {
  if (!dirty_) return;
  for (const std::uint32_t particle : particles_)
    if (particle >= particle_count)
      throw Error(fmt::format("{} names particle {}, expected one below {}: add the particles first", what,
                              particle, particle_count));
  // taken[particle][c]: whether a group on this particle has color c. A group takes the first color that is
  // free on all its particles.
  std::vector<std::vector<bool>> taken(particle_count);
  std::vector<std::vector<std::uint32_t>> groups_of;
  for (std::uint32_t i = 0; i < size(); ++i) {
    std::size_t c = 0;
    const auto is_taken = [&](std::uint32_t particle) {
      return c < taken[particle].size() && taken[particle][c];
    };
    const auto group = (*this)[i];
    while (std::any_of(group.begin(), group.end(), is_taken)) ++c;
    for (const std::uint32_t particle : group) {
      if (taken[particle].size() <= c) taken[particle].resize(c + 1);
      taken[particle][c] = true;
    }
    if (groups_of.size() <= c) groups_of.resize(c + 1);
    groups_of[c].push_back(i);
  }
  colors_ = {{}, {0}};
  for (const auto& groups : groups_of) {
    colors_.order.insert(colors_.order.end(), groups.begin(), groups.end());
    colors_.color_begin.push_back(static_cast<std::uint32_t>(colors_.order.size()));
  }
  dirty_ = false;
  SOUPLE_ASSERT(colors_.order.size() == size(), "every group has one color");
}

std::span<const std::uint32_t> ParticleGroups::color(int c) const {
  const auto k = static_cast<std::size_t>(c);
  return std::span(colors_.order)
      .subspan(colors_.color_begin[k], colors_.color_begin[k + 1] - colors_.color_begin[k]);
}

std::vector<std::uint32_t> ParticleGroups::erase_particles(std::uint32_t begin, std::uint32_t end) {
  std::vector<std::uint32_t> kept, particles, starts{0};
  for (std::uint32_t i = 0; i < size(); ++i) {
    const auto group = (*this)[i];
    if (std::any_of(group.begin(), group.end(), [&](std::uint32_t p) { return p >= begin && p < end; }))
      continue;
    for (const std::uint32_t p : group) particles.push_back(p >= end ? p - (end - begin) : p);
    starts.push_back(static_cast<std::uint32_t>(particles.size()));
    kept.push_back(i);
  }
  particles_ = std::move(particles);
  begin_ = std::move(starts);
  dirty_ = true;
  return kept;
}

}  // namespace souple
