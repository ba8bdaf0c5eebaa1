#pragma once

#include "souple/fluid/cell_order.h"
#include "souple/surface/bricks.h"
#include "souple/surface/kernels/surface_kernels.h"
#include "souple/surface/particle_kernels.h"

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace souple {

/// A fluid's field at the nodes of a grid, in bricks of 4 x 4 x 4. Only bricks where the surface may be are
/// evaluated. The other bricks are all inside if they are in the set, and all outside if not. The grid's nodes are the
/// multiples of `cell`, independent of the fluid's position, so that the mesh of a fluid at rest does not flicker.
class SurfaceField {
 public:
  /// `cell`: spacing of the grid [m]. A node is inside where the field is above `level`.
  SurfaceField(float cell, float level) : cell_(cell), level_(level) {}

  /// Replaces the field. `cell_size`: of the cells of `order` [m]. Allocates nothing when warm.
  void build(const CellOrder& order, float cell_size, const ParticleKernels& particles, Threads& threads);

  float cell() const { return cell_; }
  float level() const { return level_; }
  const Bricks& bricks() const { return bricks_; }
  /// Bit i + 4 j + 16 k: whether node (i, j, k) is inside. Brick `none` has no nodes inside.
  std::uint64_t inside(std::uint32_t brick) const { return brick == Bricks::none ? 0 : inside_[brick]; }
  /// The field at a node. In bricks that are not evaluated: twice the level inside, 0 outside.
  float value(std::uint32_t brick, std::uint32_t node) const {
    return brick == Bricks::none ? 0 : values_[std::size_t{brick} * kernels::brick_nodes + node];
  }
  /// Sorted indices of the kernels whose support overlaps an evaluated brick and the cells that begin in it.
  std::span<const std::uint32_t> kernels_near(std::uint32_t brick) const;
  /// Position of a brick's node (0, 0, 0) [m].
  std::array<float, 3> origin(std::size_t brick) const;

  /// By sorted index.
  const kernels::ParticleKernel* particle_kernels() const { return particle_kernels_; }
  const kernels::SurfaceKernels& functions() const { return *functions_; }

 private:
  struct BrickRange {
    Bricks::Coordinates first, last;
    bool holds(const Bricks::Coordinates& at) const;
  };
  /// Kernels of consecutive evaluated bricks: those of brick k are kernel[first[k]] to kernel[first[k + 1]].
  struct Gathered {
    std::vector<std::uint32_t> kernel, first;
  };
  enum class State : std::uint8_t { inside, evaluated };

  void find_boxes(const CellOrder& order, const ParticleKernels& particles, Threads& threads);
  BrickRange range_of(const KernelBox& box) const;
  void add_bricks();
  void choose_first();
  void evaluate(const CellOrder& order, const ParticleKernels& particles, Threads& threads);
  void evaluate_block(const CellOrder& order, const ParticleKernels& particles, std::size_t block);
  void gather(const CellOrder& order, const ParticleKernels& particles, std::uint32_t brick,
              std::vector<std::uint32_t>& found) const;
  void choose_next();

  float cell_, level_;
  const kernels::SurfaceKernels* functions_ = nullptr;
  const kernels::ParticleKernel* particle_kernels_ = nullptr;
  std::vector<KernelBox> cell_boxes_,
      surface_boxes_;                 // per cell: bounds of all kernels, and of those at_surface
  std::array<double, 3> furthest_{};  // that a kernel's support extends beyond its cell, per axis [m]
  double cell_size_ = 0;              // of the order's cells [m]
  Bricks bricks_;
  std::vector<State> state_;
  std::vector<std::uint64_t> inside_;
  std::vector<float> values_;
  std::vector<std::uint32_t> list_;        // bricks to evaluate, in that order
  std::vector<std::uint32_t> list_index_;  // per evaluated brick: its index in list_
  std::size_t evaluated_count_ = 0;        // bricks of list_ that are done
  std::vector<Gathered> gathered_;
};

}  // namespace souple
