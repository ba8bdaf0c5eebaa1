#pragma once

#include "souple/math/mat3.h"

#include <cstddef>
#include <cstdint>

// Kernels over the cells of a coarse lattice (multilevel/tet_levels.h), one register of cells at a time. A cell has a
// stiffness matrix K of its 8 nodes in the frame of its rest shape, and a rotation R from there:
//
//   y_a += s R sum_b K_ab R^T x_b

namespace souple::kernels {

constexpr int cell_nodes = 8;
/// Numbers of the lower triangle of K, row by row; row 3 a + i is axis i of node a.
constexpr int cell_stiffnesses = 3 * cell_nodes * (3 * cell_nodes + 1) / 2;

/// The cells of a lattice, one array per number. Every color is padded to whole registers of the widest instruction
/// set with cells of scale 0 whose nodes are all the last record.
struct CellArrays {
  const std::uint32_t* node[cell_nodes] = {};  ///< 4 times the node: the index of its record's first float
  const float* stiffness = nullptr;  ///< entry k of cell c at cell_entry(c, cell_stiffnesses, k)  [N/m]
  const float* rotation = nullptr;   ///< entry 3 column + row of R at cell_entry(c, 9, ...)
  const float* scale = nullptr;      ///< s
};

/// Lanes of the widest register.
constexpr std::size_t cell_block = 16;
/// Place of entry k of n entries of a cell, in blocks of 16 cells.
inline std::size_t cell_entry(std::size_t cell, std::size_t n, std::size_t k) {
  return (cell / cell_block * n + k) * cell_block + cell % cell_block;
}

/// Adds the products of cells [begin, end), whole registers, in order; x and y: records of the nodes, w = 0.
using ApplyCells = void (*)(const CellArrays&, const float* x, float* y, std::size_t begin, std::size_t end);

struct CellKernels {
  ApplyCells apply;
};

/// x becomes R K R^T x. `stiffness(k)` is entry k of K.
template <class T, class Stiffness>
inline void multiply_cell(const Mat3<T>& R, const Stiffness& stiffness, Vec3<T> (&x)[cell_nodes]) {
  T in[3 * cell_nodes], out[3 * cell_nodes];
  for (int a = 0; a < cell_nodes; ++a)
    for (int i = 0; i < 3; ++i) in[3 * a + i] = dot(R.column[i], x[a]);
  for (int row = 0, k = 0; row < 3 * cell_nodes; ++row) {
    T sum(0);
    for (int column = 0; column < row; ++column, ++k) {
      const T entry = stiffness(k);
      sum += entry * in[column];
      out[column] += entry * in[row];
    }
    out[row] = sum + stiffness(k++) * in[row];
  }
  for (int a = 0; a < cell_nodes; ++a)
    x[a] = R.column[0] * out[3 * a] + R.column[1] * out[3 * a + 1] + R.column[2] * out[3 * a + 2];
}

/// Compiled in one translation unit per instruction set (compile_cells.h).
template <class Isa>
const CellKernels& cell_kernels();

}  // namespace souple::kernels
