#pragma once

#include "souple/fluid/density_solver.h"

#include <cstdint>
#include <span>
#include <vector>

namespace souple {

/// A boundary surface near a fluid particle, approximated by a plane: distance = normal . x - offset.
struct BoundaryPlane {
  static constexpr std::uint32_t none = ~0u;

  Vec3f normal{};            ///< unit vector toward the fluid
  float offset = 0;          ///< m
  Vec3f motion{};            ///< of the surface in this substep [m]
  Vec3f slope{};             ///< its part of BoundarySums::slope at the last sampling [1/m]
  Vec3f push_sum{};          ///< push on the particle in this substep: sum of slope times lambda [kg m]
  float friction = 0;        ///< its part of WallFriction's w; BodyFriction overwrites it by k [kg]
  Vec3f friction_impulse{};  ///< friction impulse on the body in this substep [kg m/s]
  float share = 1;           ///< part of its half-space that other planes of its mesh do not hide
  std::uint32_t collider = none;
  // For bodies: the mesh, its triangle, and the barycentric weights of the nearest point.
  std::uint32_t mesh = none, triangle = 0;
  Vec3f weights{};
};

/// Boundary planes near each fluid particle, gathered once per substep.
class LocalBoundary {
 public:
  /// Largest distance from a particle to a plane [m].
  static float search_radius(const Smoothing& smoothing) { return 1.5f * smoothing.spacing(); }

  /// find(index, planes) appends the planes near the particle at a sorted index; runs for all particles, on
  /// all threads.
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

  /// Sorted indices of particles with planes, ascending.
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

/// A wall of which only a part counts: 1 - value' = (1 - value)^share, so that equal planes whose shares sum
/// to 1 act as one. The power is replaced by share value / (1 - (1 - share) / 2 value), which agrees to
/// second order.
Smoothing::Wall part_of(const Smoothing::Wall& wall, float share);

/// Contribution of planes to the density constraint of a particle at x. Each plane stores its own slope:
///
///   value = 1 - prod_k (1 - value_k),   slope = sum_k n_k slope_k prod_{j != k} (1 - value_j)
///
/// The product avoids double counting where planes overlap.
BoundarySums sample_planes(std::span<BoundaryPlane> planes, const Vec3f& x, const Smoothing& smoothing);

}  // namespace souple
