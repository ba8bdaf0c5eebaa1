#include "souple/broad_phase/contact_surface.h"

#include <tuple>
#include <utility>

namespace souple {
namespace {

// Properties on which a collision of two surfaces depends, except single pairs.
auto kind_of(const ContactSurface& surface) {
  return std::tuple(surface.filter.groups, surface.filter.mask, surface.particles_only, surface.immovable,
                    surface.keeps_shape);
}

}  // namespace

ParticlePairs::ParticlePairs(std::vector<Edge> pairs, std::vector<Edge> bodies)
    : pairs_(std::move(pairs)), bodies_(std::move(bodies)) {
  std::sort(bodies_.begin(), bodies_.end());
  for (Edge& pair : pairs_) {
    pair = {first_of(pair[0]), first_of(pair[1])};
    if (pair[0] > pair[1]) std::swap(pair[0], pair[1]);
  }
  std::sort(pairs_.begin(), pairs_.end());
  pairs_.erase(std::unique(pairs_.begin(), pairs_.end()), pairs_.end());
}

// Most of many surfaces are alike, so a few representatives tell that no pair can collide. Otherwise one of the first
// pairs does.
bool any_may_collide(std::span<const ContactSurface> surfaces) {
  std::vector<ContactSurface> kinds;
  for (const ContactSurface& surface : surfaces) {
    if (surface.self_collision) return true;
    // Two of a kind may collide with each other.
    if (std::count_if(kinds.begin(), kinds.end(),
                      [&](const ContactSurface& kind) { return kind_of(kind) == kind_of(surface); }) < 2)
      kinds.push_back(surface), kinds.back().ignored_surfaces.clear();
  }
  const auto any_of = [](std::span<const ContactSurface> of) {
    for (std::size_t a = 0; a < of.size(); ++a)
      for (std::size_t b = 0; b < a; ++b)
        if (may_collide(of, a, b)) return true;
    return false;
  };
  return any_of(kinds) && any_of(surfaces);
}

}  // namespace souple
