#pragma once

#include "souple/solver/coloring.h"
#include "souple/solver/facets.h"
#include "souple/state/bytes.h"
#include "souple/threads/threads.h"

#include <string_view>
#include <utility>

namespace souple {

/// The particles of constraints whose number of particles is known only at run time, in the order in which
/// they were added, and their colors. Used by shape matching, enclosed volumes and custom constraints.
class ParticleGroups {
 public:
  /// Adds a group. Throws Error when it is empty or names a particle twice; the message begins with `what`.
  void add(std::span<const std::uint32_t> particles, std::string_view what);

  std::size_t size() const { return begin_.size() - 1; }
  /// Particles of group i.
  std::span<const std::uint32_t> operator[](std::size_t i) const {
    return std::span(particles_).subspan(begin_[i], begin_[i + 1] - begin_[i]);
  }

  /// Colors the groups if any was added or erased. Groups of one color share no particle; each group takes
  /// the first free color. Throws Error when a particle is not below particle_count.
  void prepare(std::size_t particle_count, std::string_view what);
  int color_count() const { return static_cast<int>(colors_.color_begin.size()) - 1; }
  /// The groups of color c, ascending.
  std::span<const std::uint32_t> color(int c) const;

  /// Calls f(index of the group, color), color after color.
  template <class Function>
  void for_each(const Function& f) const {
    for (int c = 0; c < color_count(); ++c)
      for (const std::uint32_t i : color(c)) f(i, c);
  }

  /// Calls f(index of the group), color after color, each color on all threads.
  template <class Function>
  void for_each(Threads& threads, std::size_t grain, const Function& f) const {
    for (int c = 0; c < color_count(); ++c) {
      const std::span<const std::uint32_t> groups = color(c);
      threads.for_each(groups.size(), grain, [&](std::size_t begin, std::size_t end) {
        for (const std::uint32_t i : groups.subspan(begin, end - begin)) f(i);
      });
    }
  }

  std::size_t bytes() const { return bytes_of(particles_, begin_, colors_.order, colors_.color_begin); }
  /// Removes groups that name a particle of [begin, end) and renumbers the others. Returns the indices of the
  /// remaining groups, ascending.
  std::vector<std::uint32_t> erase_particles(std::uint32_t begin, std::uint32_t end);

 private:
  std::vector<std::uint32_t> particles_;
  std::vector<std::uint32_t> begin_{0};
  Coloring colors_{{}, {0}};
  bool dirty_ = false;
};

/// Constraints on groups of particles.
class GroupProjector : public Projector, public ElasticFacet {
 public:
  std::size_t size() const final { return groups_.size(); }
  void prepare(std::size_t particle_count) final { groups_.prepare(particle_count, kind()); }
  int color_count() const final { return groups_.color_count(); }
  std::size_t color_size(int color) const final { return groups_.color(color).size(); }
  std::uint32_t particle_of(int color, std::size_t index, const ParticleView& particles) const final {
    return particles.first_movable(groups_[groups_.color(color)[index]]);
  }
  using Projector::project;
  void project(int color, std::size_t begin, std::size_t end, const ParticleView& particles,
               const Substep& substep) final {
    for (const std::uint32_t i : groups_.color(color).subspan(begin, end - begin))
      project_one(i, particles, substep);
  }
  void damp(const ParticleView& particles, std::span<Vec4f> velocity, const Substep& substep,
            Threads& threads) final {
    groups_.for_each(threads, facets().grain,
                     [&](std::uint32_t i) { damp_one(i, particles, velocity, substep); });
  }

 protected:
  virtual void project_one(std::size_t i, const ParticleView& particles, const Substep& substep) = 0;
  virtual void damp_one(std::size_t i, const ParticleView& particles, std::span<Vec4f> velocity,
                        const Substep& substep) = 0;

  ParticleGroups groups_;
};

/// Keeps the items whose indices are listed, in order.
template <class Item>
void keep_only(std::vector<Item>& items, std::span<const std::uint32_t> kept) {
  std::vector<Item> result;
  result.reserve(kept.size());
  for (const std::uint32_t i : kept) result.push_back(std::move(items[i]));
  items = std::move(result);
}

}  // namespace souple
