#pragma once

#include "souple/simd/pack.h"
#include "souple/solver/kernels/cells.h"

// Included only by translation units that are compiled for one instruction set; every template here has the
// tag of that instruction set as parameter.

namespace souple::kernels {

template <class Isa>
[[gnu::flatten]] void apply_cells(const CellArrays& of, const float* x, float* y, std::size_t begin,
                                  std::size_t end) {
  using T = simd::Pack<Isa>;
  const CellArrays cells = of;
  for (std::size_t c = begin; c < end; c += Isa::lanes) {
    Vec3<T> v[cell_nodes];
    for (int a = 0; a < cell_nodes; ++a) {
      typename Isa::Vector r[4];
      for (int j = 0; j < 4; ++j) r[j] = Isa::load_records(x, cells.node[a] + c + j);
      simd::transpose<Isa>(r);
      v[a] = {T(r[0]), T(r[1]), T(r[2])};
    }
    const float* const rotation = cells.rotation + cell_entry(c, 9, 0);
    const float* const stiffness = cells.stiffness + cell_entry(c, cell_stiffnesses, 0);
    Mat3<T> R;
    for (int k = 0; k < 9; ++k)
      R.column[k / 3][k % 3] = T::load(rotation + static_cast<std::size_t>(k) * cell_block);
    multiply_cell(
        R, [stiffness](int k) { return T::load(stiffness + static_cast<std::size_t>(k) * cell_block); }, v);
    const T scale = T::load(cells.scale + c);
    for (int a = 0; a < cell_nodes; ++a) {
      typename Isa::Vector r[4] = {(v[a].x * scale).v, (v[a].y * scale).v, (v[a].z * scale).v,
                                   typename Isa::Vector{}};
      simd::transpose<Isa>(r);
      for (int j = 0; j < 4; ++j) {
        const std::uint32_t* const at = cells.node[a] + c + j;
        Isa::store_records(y, at, Isa::load_records(y, at) + r[j]);
      }
    }
  }
}

template <class Isa>
const CellKernels& cell_kernels() {
  static constexpr CellKernels kernels{apply_cells<Isa>};
  return kernels;
}

}  // namespace souple::kernels
