#pragma once

#include "souple/math/vec3.h"
#include "souple/math/vec4.h"

#include <cstddef>
#include <cstdint>

// Sums over the neighbors of a fluid particle, one register at a time, compiled once per instruction set.
// Each sum has sixteen partial sums: term k goes to partial sum k mod 16. A fixed tree combines them, so
// results are identical for all register widths.

namespace souple::kernels {

/// W(r) = value_factor value(r / h), grad W = slope_factor slope(r / h) d; see shapes.h.
struct SmoothingFactors {
  float h = 1;             ///< support [m]
  float inverse_h = 1;     ///< 1/m
  float value_factor = 0;  ///< 1/m^3
  float slope_factor = 0;  ///< < 0 [1/m^5]
  float scale = 1;         ///< power of two near V / m^3, by which sums of squares are scaled
};

/// Sums for a particle's density constraint.
struct DensitySums {
  float density;           ///< sum_j W_ij [1/m^3]
  float gradient_squared;  ///< scale^2 sum_j w_j |grad W_ij|^2 [1/(kg m^2)]
  Vec3f gradient;          ///< sum_j grad W_ij [1/m^4]
};

/// Repulsion against clumping: adds strength (value(r / h) scale)^4 to q_i + q_j.
struct Repulsion {
  float strength = 0, scale = 1;
};

/// The lists of consecutive particles: that of begin + k is entry[first[k]] up to entry[first[k + 1]].
struct NeighborLists {
  const std::uint32_t *entry, *first;
  std::uint32_t begin, end;
};

/// Lists hold four times the sorted index of each neighbor. They are padded to a multiple of sixteen with a record so
/// far away that its terms are zero.
struct DensityKernels {
  /// `sums` and `push` of all particles of `lists`, in one call; begin + k goes to result[k].
  void (*sums_of)(const Vec4f* records, const NeighborLists& lists, const SmoothingFactors& factors,
                  DensitySums* result);
  void (*push_of)(const Vec4f* records, const NeighborLists& lists, const SmoothingFactors& factors,
                  Vec3f* result);
  /// push_of with a repulsion between each pair.
  void (*repel_of)(const Vec4f* records, const NeighborLists& lists, const SmoothingFactors& factors,
                   const Repulsion& repulsion, Vec3f* result);
  /// `records`: x, y, z and the inverse mass w.
  DensitySums (*sums)(const Vec4f* records, const Vec4f& at, const std::uint32_t* list, std::size_t count,
                      const SmoothingFactors& factors);
  /// sum_j (q_i + q_j) grad W_ij; `records` and `at`: x, y, z and q.
  Vec3f (*push)(const Vec4f* records, const Vec4f& at, const std::uint32_t* list, std::size_t count,
                const SmoothingFactors& factors);
  /// sum_j (v_j - v_i) W_ij; `values`: v of each particle; `value`: the particle's own.
  Vec3f (*spread)(const Vec4f* records, const Vec4f* values, const Vec4f& at, const Vec4f& value,
                  const std::uint32_t* list, std::size_t count, const SmoothingFactors& factors);
};

template <class Isa, class Shape>
const DensityKernels& density_kernels();

}  // namespace souple::kernels
