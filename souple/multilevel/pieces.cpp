#include "souple/multilevel/pieces.h"

namespace souple {

LinkedPieces::LinkedPieces(std::span<const Link> links, std::size_t particles)
    : sets_(particles), size_(particles) {
  for (const Link& link : links) sets_.join(link.a, link.b);
  for (std::uint32_t i = 0; i < particles; ++i) ++size_[root(i)];
}

std::vector<bool> near_isolated_pins(std::span<const Link> links, std::span<const float> masses, int radius) {
  LinkedPieces components(links, masses.size());
  std::vector<std::size_t> pinned(masses.size());  // per piece, at its root
  for (std::uint32_t i = 0; i < pinned.size(); ++i) pinned[components.root(i)] += masses[i] == 0;
  std::vector<bool> near(masses.size());
  for (std::uint32_t i = 0; i < near.size(); ++i) {
    const std::size_t pins = pinned[components.root(i)];
    near[i] = masses[i] == 0 && 2 * pins * pins < components.size(i) - pins;
  }
  for (int step = 0; step < radius; ++step) {
    const std::vector<bool> before = near;
    for (const Link& link : links)
      if (before[link.a] || before[link.b]) near[link.a] = near[link.b] = true;
  }
  return near;
}

}  // namespace souple
