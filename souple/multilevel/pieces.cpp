#include "souple/multilevel/pieces.h"

#include <algorithm>
#include <numeric>

namespace souple {

Components::Components(std::span<const Link> links, std::size_t particles)
    : root_(particles), size_(particles) {
  std::iota(root_.begin(), root_.end(), 0u);
  for (const Link& link : links) {
    const std::uint32_t a = root(link.a), b = root(link.b);
    root_[std::max(a, b)] = std::min(a, b);
  }
  for (std::uint32_t i = 0; i < particles; ++i) ++size_[root(i)];
}

std::uint32_t Components::root(std::uint32_t i) {
  while (root_[i] != i) i = root_[i] = root_[root_[i]];
  return i;
}

std::vector<bool> near_isolated_pins(std::span<const Link> links, std::span<const float> masses, int radius) {
  Components components(links, masses.size());
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
