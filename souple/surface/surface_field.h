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

/// A fluid's field at the nodes of a grid, in bricks of 4 x 4 x 4: numbers only where the surface may be.
/// Elsewhere a brick is known to be all inside, or is not there and all outside. The grid's nodes are the
/// multiples of `cell`, wherever the fluid is, so that the mesh of what rests does not flicker.
class SurfaceField {
 public:
  /// `cell` of the grid [m]; a node is inside where the field is above `level`.
  SurfaceField(float cell, float level) : cell_(cell), level_(level) {}

  /// Replaces what was there; `cell_size` is that of the order [m]. Allocates nothing when warm.
  void build(const CellOrder& order, float cell_size, const ParticleKernels& particles, Threads& threads);

  float cell() const { return cell_; }
  float level() const { return level_; }
  const Bricks& bricks() const { return bricks_; }
  /// Bit i + 4 j + 16 k: that node is inside. `none` has no nodes inside.
  std::uint64_t inside(std::uint32_t brick) const { return brick == Bricks::none ? 0 : inside_[brick]; }
  /// 0 where a brick was not evaluated and is outside; twice the level inside.
  float value(std::uint32_t brick, std::uint32_t node) const {
    return brick == Bricks::none ? 0 : values_[std::size_t{brick} * kernels::brick_nodes + node];
  }
  /// The kernels that reach an evaluated brick, or the cells that begin in it.
  std::span<const std::uint32_t> kernels_near(std::uint32_t brick) const;
  /// Where node (0, 0, 0) lies [m].
  std::array<float, 3> origin(std::size_t brick) const;

  /// By place of the order.
  const kernels::ParticleKernel* particle_kernels() const { return particle_kernels_; }
  const kernels::SurfaceKernels& functions() const { return *functions_; }

 private:
  struct BrickRange {
    Bricks::Coordinates first, last;
    bool holds(const Bricks::Coordinates& at) const;
  };
  /// Of consecutive bricks that are evaluated: which kernels reach each.
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
  std::vector<KernelBox> cell_boxes_, surface_boxes_;  // by cell of the order: of all, of some
  std::array<double, 3> furthest_{};                   // that a kernel reaches from its particle [m]
  double cell_size_ = 0;                               // of the order
  Bricks bricks_;
  std::vector<State> state_;
  std::vector<std::uint64_t> inside_;
  std::vector<float> values_;
  std::vector<std::uint32_t> list_;        // bricks evaluated so far, in the order of their evaluation
  std::vector<std::uint32_t> list_index_;  // of each evaluated brick in the list
  std::size_t evaluated_count_ = 0;        // bricks in which the field was computed
  std::vector<Gathered> gathered_;
};

}  // namespace souple
