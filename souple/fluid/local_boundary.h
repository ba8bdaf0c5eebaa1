#pragma once

#include "souple/fluid/density_solver.h"

#include <cstdint>
#include <span>
#include <vector>

namespace souple {

/// A surface near a particle of a fluid, as the plane it is there: distance = normal . x - offset.
struct BoundaryPlane {
  static constexpr std::uint32_t none = ~0u;

  Vec3f normal{};            ///< unit, towards the fluid
  float offset = 0;          ///< m
  Vec3f motion{};            ///< of the surface in this substep [m]
  Vec3f slope{};             ///< its part in that of the sum, of the last look [1/m]
  Vec3f push_sum{};          ///< the particle, in this substep: sum of slope times lambda [kg m]
  float friction = 0;        ///< its part in how all of them hold a flow along them, as WallFriction says
  Vec3f friction_impulse{};  ///< the body, in this substep: impulse [kg m/s]
  std::uint32_t collider = none;
  // Of a body: which mesh, its triangle, and the weights of that one's corners in the nearest point.
  std::uint32_t mesh = none, triangle = 0;
  Vec3f weights{};
};

/// What is near each particle of a fluid besides fluid, found once a substep.
class LocalBoundary {
 public:
  /// Planes as far as this from a particle count. [m]
  static float search_radius(const Smoothing& smoothing) { return 1.5f * smoothing.spacing(); }

  /// find(index, planes) appends the planes near a index; called for all, on all threads.
  template <class Find>
  void gather(std::size_t count, const Find& find, Threads& threads) {
    const std::size_t blocks = (count + block_size - 1) / block_size;
    if (blocks_.size() < blocks) blocks_.resize(blocks);
    threads.for_each(blocks, 1, [&](std::size_t first, std::size_t last) {
      for (std::size_t b = first; b < last; ++b) {
        Block& block = blocks_[b];
        block.planes.clear();
        block.near.clear();
        for (std::size_t k = 0; k < block_size; ++k) {
          block.first[k] = static_cast<std::uint32_t>(block.planes.size());
          const std::size_t index = b * block_size + k;
          if (index < count) find(index, block.planes);
          if (block.planes.size() > block.first[k]) block.near.push_back(static_cast<std::uint32_t>(index));
        }
        block.first[block_size] = static_cast<std::uint32_t>(block.planes.size());
      }
    });
    near_.clear();
    for (std::size_t b = 0; b < blocks; ++b)
      near_.insert(near_.end(), blocks_[b].near.begin(), blocks_[b].near.end());
  }

  /// The count that have planes, ascending.
  std::span<const std::uint32_t> near() const { return near_; }

  std::span<const BoundaryPlane> of(std::size_t index) const {
    const Block& block = blocks_[index / block_size];
    const std::size_t k = index % block_size;
    return {block.planes.data() + block.first[k], block.first[k + 1] - block.first[k]};
  }
  std::span<BoundaryPlane> of(std::size_t index) {
    const auto planes = static_cast<const LocalBoundary&>(*this).of(index);
    return {const_cast<BoundaryPlane*>(planes.data()),
            planes.size()};  // NOLINT: of this object, which is not
  }

 private:
  static constexpr std::size_t block_size = 256;
  struct Block {
    std::vector<BoundaryPlane> planes;
    std::vector<std::uint32_t> near;
    std::array<std::uint32_t, block_size + 1> first{};
  };
  std::vector<Block> blocks_;
  std::vector<std::uint32_t> near_;
};

/// What planes add to a particle at x; each takes down its part:
///
///   value = 1 - prod_k (1 - value_k),   slope = sum_k n_k slope_k prod_{j != k} (1 - value_j)
///
/// What one of them hides the others do not add.
BoundarySums sample_planes(std::span<BoundaryPlane> planes, const Vec3f& x, const Smoothing& smoothing);

}  // namespace souple
