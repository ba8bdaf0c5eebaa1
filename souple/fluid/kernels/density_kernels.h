#pragma once

#include "souple/math/vec3.h"
#include "souple/state/particles.h"

#include <cstddef>
#include <cstdint>

// Sums over the neighbors of a fluid's particle, a register's worth at a time: compiled once for each
// instruction set. Every sum goes to sixteen partial sums, term k to the (k mod 16)-th, which are then
// combined as a tree: the same bits however wide the registers are.

namespace souple::kernels {

/// W(r) = value_factor value(r / h), grad W = slope_factor slope(r / h) d; see shapes.h.
struct SmoothingFactors {
  float h = 1;             ///< support [m]
  float inverse_h = 1;     ///< 1/m
  float value_factor = 0;  ///< 1/m^3
  float slope_factor = 0;  ///< < 0 [1/m^5]
};

/// What the density of a particle is made of.
struct DensitySums {
  float density;           ///< sum_j W_ij [1/m^3]
  float gradient_squared;  ///< sum_j w_j |grad W_ij|^2 [1/(kg m^8)]
  Vec3f gradient;          ///< sum_j grad W_ij [1/m^4]
};

/// A push that keeps particles from closing_speed: added to q_i + q_j is strength (value(r / h) scale)^4.
struct Repulsion {
  float strength = 0, scale = 1;
};

/// The lists of consecutive places: of place begin + k, entry[first[k]] up to entry[first[k + 1]].
struct NeighborLists {
  const std::uint32_t *entry, *first;
  std::uint32_t begin, end;
};

/// Lists hold the place of each neighbor times four, padded to whole sixteens with that of a record so far
/// away that its terms are zero.
struct DensityKernels {
  /// `sums` and `push` of place begin + k go to result[k]: without a call for each.
  void (*sums_of)(const Vec4f* records, const NeighborLists& lists, const SmoothingFactors& factors,
                  DensitySums* result);
  void (*push_of)(const Vec4f* records, const NeighborLists& lists, const SmoothingFactors& factors,
                  Vec3f* result);
  /// The same with a repulsion of each pair.
  void (*repel_of)(const Vec4f* records, const NeighborLists& lists, const SmoothingFactors& factors,
                   const Repulsion& repulsion, Vec3f* result);
  /// `records`: x, y, z and the inverse mass w.
  DensitySums (*sums)(const Vec4f* records, const Vec4f& at, const std::uint32_t* list, std::size_t count,
                      const SmoothingFactors& factors);
  /// sum_j (q_i + q_j) grad W_ij; `records`: x, y, z and q, `at` too.
  Vec3f (*push)(const Vec4f* records, const Vec4f& at, const std::uint32_t* list, std::size_t count,
                const SmoothingFactors& factors);
  /// sum_j (v_j - v_i) W_ij, where `values` has v of each place, `value` its own.
  Vec3f (*spread)(const Vec4f* records, const Vec4f* values, const Vec4f& at, const Vec4f& value,
                  const std::uint32_t* list, std::size_t count, const SmoothingFactors& factors);
};

/// One neighbor after the other, to compare with.
struct PlainLanes;

template <class Isa, class Shape>
const DensityKernels& density_kernels();

}  // namespace souple::kernels
