#pragma once

#include "souple/math/vec4.h"

#include <cstddef>
#include <cstdint>

// Loops over particles for a fluid's surface, compiled once for each instruction set. Lanes are neighbors
// (with sixteen partial sums, as in density_kernels.h), nodes or points. Kernels are added one after another.
// So results are the same bits for any register width.

namespace souple::kernels {

/// Weighted moments of a particle's neighborhood, itself included, about itself:
/// w = 1 - (r / radius)^3 (Yu and Turk 2013, equation 11), d = x_j - x_i.
struct Moments {
  float weight;                  ///< sum w
  float first[3];                ///< sum w d
  float xx, xy, xz, yy, yz, zz;  ///< sum w d d^T
};

/// A particle's term of the field: weight (1 - |G (x - center)|^2)^3 where the parenthesis is positive. It is poly6 of
/// Müller et al. 2003, deformed by G as in Yu and Turk 2013, equation 8.
struct alignas(64) ParticleKernel {
  float center[3];               ///< m
  float weight;                  ///< V W(0), no unit
  float xx, xy, xz, yy, yz, zz;  ///< G, symmetric [1/m]
  float shift[3];                ///< from the particle to the center [m]
  float crowd;                   ///< number of neighbors / (2 few_neighbors), at most 1 (SurfaceOptions)
  float extent_z;                ///< extent of the support from the center along z [m]
  float unused;
};

/// Nodes of a brick: along each axis, and in all.
inline constexpr int brick_side = 4, brick_nodes = brick_side * brick_side * brick_side;

/// Points component by component; their number is a multiple of 16.
struct FieldPoints {
  const float* at[3];  ///< m
  float* value;        ///< the field
  float* gradient[3];  ///< 1/m
  // Means over the kernels, weighted by their terms of the field.
  float* shift[3];  ///< m
  float* crowd;
};

struct SurfaceKernels {
  /// `records`: x, y, z and an unused float. `list`: padded to a multiple of 16 as Neighbors does.
  Moments (*moments)(const Vec4f* records, const Vec4f& at, const std::uint32_t* list, std::size_t count,
                     float inverse_radius);
  /// The field at the nodes origin + cell (i, j, k), written to values[i + 4 j + 16 k].
  void (*brick)(const ParticleKernel* kernels, const std::uint32_t* list, std::size_t count,
                const float* origin, float cell, float* values);
  /// The field of `count` kernels at `point_count` points, a multiple of 16.
  void (*points)(const ParticleKernel* kernels, const std::uint32_t* list, std::size_t count,
                 const FieldPoints& points, std::size_t point_count);
};

template <class Isa>
const SurfaceKernels& surface_kernels();

}  // namespace souple::kernels
