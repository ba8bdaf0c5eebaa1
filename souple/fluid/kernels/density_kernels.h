#pragma once

#include "souple/math/vec3.h"
#include "souple/state/particles.h"

#include <cstddef>
#include <cstdint>

// Sums over the neighbours of a fluid's particle, a register's worth at a time: compiled once for each
// instruction set. Every sum goes to sixteen partial sums, term k to the (k mod 16)-th, which are then
// combined as a tree: the same bits however wide the registers are.

namespace souple::kernels {

/// Smoothing kernels of support h (Müller et al. 2003, "Particle-based fluid simulation for interactive
/// applications", equations 20 and 21), times a factor each that makes their lattice sums exact:
///
///   W(r)      = poly6 (h^2 - r^2)^3
///   grad W(r) = spiky (h - r)^2 d / r,   d = x_i - x_j, spiky < 0
struct SmoothingFactors {
  float h = 1;      ///< m
  float poly6 = 0;  ///< 1/m^9
  float spiky = 0;  ///< 1/m^6
};

/// What the density of a particle is made of.
struct DensitySums {
  float density;           ///< sum_j W_ij [1/m^3]
  float gradient_squared;  ///< sum_j w_j |grad W_ij|^2 [1/(kg m^8)]
  Vec3f gradient;          ///< sum_j grad W_ij [1/m^4]
};

/// Lists hold the place of each neighbour times four, padded to whole sixteens with that of a record so far
/// away that its terms are zero.
struct DensityKernels {
  /// `records`: x, y, z and the inverse mass w.
  DensitySums (*sums)(const Vec4f* records, const Vec4f& at, const std::uint32_t* list, std::size_t count,
                      const SmoothingFactors& factors);
  /// sum_j (u_i - u_j) . grad W_ij, where `motion` has u; `records` as above.
  float (*rate)(const Vec4f* records, const Vec4f* motion, const Vec4f& at, const Vec4f& u,
                const std::uint32_t* list, std::size_t count, const SmoothingFactors& factors);
  /// sum_j (q_i + q_j) grad W_ij; `records`: x, y, z and q, `at` too.
  Vec3f (*push)(const Vec4f* records, const Vec4f& at, const std::uint32_t* list, std::size_t count,
                const SmoothingFactors& factors);
};

/// Sixteen lanes of plain floats, to compare with.
struct PlainLanes;

template <class Set>
const DensityKernels& density_kernels();

}  // namespace souple::kernels
