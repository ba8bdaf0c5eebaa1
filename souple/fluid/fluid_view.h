#pragma once

#include "souple/fluid/neighbors.h"
#include "souple/fluid/smoothing.h"

#include <span>

namespace souple {

/// A fluid's particles by sorted index, as input of forces. Both arrays have one extra record that pads
/// neighbor lists: its x is far away and its v is zero.
struct FluidView {
  std::span<const Vec4f> x;  ///< x, y, z [m] and the inverse mass w > 0 [1/kg]
  std::span<Vec4f> v;        ///< velocity [m/s] and dynamic viscosity mu >= 0 [Pa s]
  const Neighbors& neighbors;
  const Smoothing& smoothing;

  std::size_t size() const { return x.size() - 1; }

  /// f(sorted index, its padded list), for all particles.
  template <class Function>
  void for_lists(Threads& threads, const Function& f) const {
    const auto blocks = neighbors.blocks();
    threads.each(blocks.size(), 1, [&](std::size_t b) {
      for (std::uint32_t index = blocks[b].begin; index < blocks[b].end; ++index)
        f(index, blocks[b].padded(index));
    });
  }
};

/// f(k) for k in [0, n), in parallel.
template <class Function>
void for_each_index(std::size_t n, Threads& threads, const Function& f) {
  threads.each(n, 256, [&](std::size_t k) { f(k); });
}

}  // namespace souple
