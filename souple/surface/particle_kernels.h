#pragma once

#include "souple/fluid/neighbors.h"
#include "souple/surface/kernels/surface_kernels.h"
#include "souple/surface/surface_options.h"

#include <cstdint>
#include <span>
#include <vector>

namespace souple {

/// Axis-aligned bounds of kernels; empty where lo > hi.
struct KernelBox {
  float lo[3], hi[3];  ///< m

  static KernelBox none();
  bool empty() const { return !(lo[0] <= hi[0]); }
  bool overlaps(const KernelBox& b) const {
    // Without branches: most boxes miss, on any of six sides.
    const bool x = (lo[0] <= b.hi[0]) & (b.lo[0] <= hi[0]), y = (lo[1] <= b.hi[1]) & (b.lo[1] <= hi[1]),
               z = (lo[2] <= b.hi[2]) & (b.lo[2] <= hi[2]);
    return x & y & z;
  }
  void add(const KernelBox& other);
};

/// The kernel of each particle of a fluid, by its index in a CellOrder (sorted index).
class ParticleKernels {
 public:
  explicit ParticleKernels(const SurfaceOptions& options);

  /// Replaces all kernels. Allocates nothing when warm.
  void find(const CellOrder& order, const Neighbors& neighbors, Threads& threads);

  std::span<const kernels::ParticleKernel> kernels() const { return kernels_; }
  /// Per kernel: bounds of its support.
  std::span<const KernelBox> boxes() const { return boxes_; }
  /// Per kernel: 1 where the surface may be within its support, since its neighbors are on one side or few.
  std::span<const std::uint8_t> at_surface() const { return at_surface_; }
  /// Whether neighbors surround a particle, unlike in a sheet or thread. It then has at least three quarters of the
  /// neighbors of a particle inside a fluid.
  bool is_surrounded(std::size_t neighbors) const { return neighbors >= surrounded_count_; }

 private:
  void smooth_shift(std::uint32_t sorted_index, std::span<const std::uint32_t> list);
  void find_at(std::uint32_t sorted_index, std::span<const std::uint32_t> list, std::size_t count);
  Vec3f set_ball(kernels::ParticleKernel& kernel, float radius) const;
  Vec3f set_ellipsoid(kernels::ParticleKernel& kernel, const kernels::Moments& moments) const;

  SurfaceOptions options_;
  const kernels::SurfaceKernels* functions_ = nullptr;
  float variance_;  // along an axis, of the neighbors of a particle inside the fluid [m^2]
  std::size_t surrounded_count_;
  std::vector<Vec4f> records_;
  std::vector<kernels::ParticleKernel> kernels_;
  std::vector<Vec3f> shift_;  // per kernel: from the particle to the center [m]
  std::vector<KernelBox> boxes_;
  std::vector<std::uint8_t> at_surface_;
};

}  // namespace souple
