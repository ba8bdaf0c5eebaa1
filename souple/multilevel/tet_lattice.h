#pragma once

#include "souple/constraints/constraint_set.h"
#include "souple/constraints/neo_hookean.h"
#include "souple/solver/kernels/cells.h"

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace souple {

/// A coarse lattice of box-shaped cells around the rest shape of a soft body, which moves the body's particles by
/// trilinear interpolation. Parts of the body may lie in one cell without being connected there. They have cells and
/// nodes of their own, so that an arm is not tied to the hip beside it.
struct TetLattice {
  /// Stiffness matrix of the tets of a cell, for displacements that are trilinear in it (lower triangle).
  using Stiffness = std::array<float, kernels::cell_stiffnesses>;
  struct Cell {
    std::array<std::uint32_t, kernels::cell_nodes> node{};
    /// Deformation gradient from positions of a few particles: F = sum_k x[sample[k]] gradient[k]^T, k in
    /// [sample_begin, sample_end).
    std::uint32_t sample_begin = 0, sample_end = 0;
    float shear = 0, bulk = 0;  ///< Lamé's mu and lambda, means of the tets [Pa]
  };

  std::vector<std::uint32_t> particle;  ///< of the body, ascending
  /// Per particle: its nodes and their weights, which sum to 1.
  std::vector<std::array<std::uint32_t, kernels::cell_nodes>> parent;
  std::vector<std::array<float, kernels::cell_nodes>> weight;
  /// Per particle: upper bound of the stiffness against its displacement relative to its neighbors. [N/m]
  std::vector<float> stiffness;
  std::vector<Cell> cells;
  std::vector<Stiffness> cell_stiffness;  ///< per cell [N/m]
  std::vector<std::uint32_t> sample;      ///< numbers of `particle`
  std::vector<Vec3f> gradient;            ///< [1/m]
  std::size_t node_count = 0;
  float cell_size = 0;  ///< shortest side of a cell [m]
};

/// The lattice of a connected body of tets, with cells about three times as wide as those of a grid of as many tets.
/// The rest shape follows from the rest shapes of the tets.
TetLattice build_tet_lattice(const ConstraintSet<NeoHookean>& set, std::span<const std::uint32_t> tets);

}  // namespace souple
