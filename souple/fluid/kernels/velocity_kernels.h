#pragma once

#include "souple/fluid/kernels/density_kernels.h"

// Sums over the neighbors of a fluid particle that change velocities. density_kernels.h describes the lists
// and the order of summation.

namespace souple::kernels {

/// Attraction a c(r / h) along the line between two particles, and flattening b value(r / h) times the
/// difference of their normals; see surface_tension.h.
struct CohesionFactors {
  float attraction = 0;  ///< a [N]
  float flattening = 0;  ///< b [N]
};

/// `records`: x, y, z and any w; `values`: the values to sum; `at` and `value` are the particle's own. mu_ij
/// is the harmonic mean of the two viscosities [Pa s], 0 if one is 0.
struct VelocityKernels {
  /// sum_j mu_ij W_ij (v_j - v_i); values: v and mu.
  Vec3f (*exchange)(const Vec4f* records, const Vec4f* values, const Vec4f& at, const Vec4f& value,
                    const std::uint32_t* list, std::size_t count, const SmoothingFactors& factors);
  /// sum_j mu_ij (1 - r / h) (v_j - v_i) . d / (d^2 + 0.0001 h^2) d, d = x_i - x_j; values: v and mu.
  Vec3f (*strain)(const Vec4f* records, const Vec4f* values, const Vec4f& at, const Vec4f& value,
                  const std::uint32_t* list, std::size_t count, const SmoothingFactors& factors);
  /// sum_j grad W_ij x (v_j - v_i); values: v.
  Vec3f (*curl)(const Vec4f* records, const Vec4f* values, const Vec4f& at, const Vec4f& value,
                const std::uint32_t* list, std::size_t count, const SmoothingFactors& factors);
  /// sum_j (|u| - u . d / r) (1 - r / h), u = v_i - v_j: the closing speed of neighbors; values: v.
  float (*closing_speed)(const Vec4f* records, const Vec4f* values, const Vec4f& at, const Vec4f& value,
                         const std::uint32_t* list, std::size_t count, const SmoothingFactors& factors);
  /// -sum_j 2 / (rho_i + rho_j) (a c(r / h) d / r + b value(r / h) (n_i - n_j)); values: n and rho > 0.
  Vec3f (*cohesion)(const Vec4f* records, const Vec4f* values, const Vec4f& at, const Vec4f& value,
                    const std::uint32_t* list, std::size_t count, const SmoothingFactors& factors,
                    const CohesionFactors& cohesion);
};

template <class Isa, class Shape>
const VelocityKernels& velocity_kernels();

}  // namespace souple::kernels
