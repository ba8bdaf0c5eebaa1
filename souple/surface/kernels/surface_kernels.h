#pragma once

#include "souple/solver/instruction_set.h"
#include "souple/state/particles.h"

#include <cstddef>
#include <cstdint>

// The loops of a fluid's surface over particles, compiled once for each instruction set. Lanes are neighbors
// (sums go to sixteen partial sums, as in density_kernels.h), nodes or points; kernels are added one after
// the other. So results are the same bits however wide the registers are.

namespace souple::kernels {

/// Weighted moments of a particle's neighborhood, itself included, about itself:
/// w = 1 - (r / radius)^3 (Yu and Turk 2013, equation 11), d = x_j - x_i.
struct Moments {
  float weight;                  ///< sum w
  float first[3];                ///< sum w d
  float xx, xy, xz, yy, yz, zz;  ///< sum w d d^T
};

/// What a particle adds to the field: weight (1 - |G (x - center)|^2)^3 where that is positive (poly6 of
/// Müller et al. 2003, bent by G as in Yu and Turk 2013, equation 8).
struct alignas(64) ParticleKernel {
  float center[3];               ///< m
  float weight;                  ///< V W(0), no unit
  float xx, xy, xz, yy, yz, zz;  ///< G, symmetric [1/m]
  float shift[3];                ///< from the particle to the center [m]
  float crowd;                   ///< how many neighbors, in [0, 1]: see SurfaceOptions::few_neighbors
  float reach_up;                ///< along z [m]
  float unused;
};

/// Nodes of a brick along each axis, and all of them.
inline constexpr int brick_side = 4, brick_nodes = brick_side * brick_side * brick_side;

/// Points component by component, in whole sixteens.
struct FieldPoints {
  const float* at[3];  ///< m
  float* value;        ///< the field
  float* gradient[3];  ///< 1/m
  // Of the kernels, weighted with what each adds to the field.
  float* shift[3];  ///< m
  float* crowd;
};

struct SurfaceKernels {
  /// `records`: x, y, z and anything; `list` padded to whole sixteens as Neighbors does.
  Moments (*moments)(const Vec4f* records, const Vec4f& at, const std::uint32_t* list, std::size_t count,
                     float inverse_radius);
  /// The field at the nodes origin + cell (i, j, k), written to values[i + 4 j + 16 k].
  void (*brick)(const ParticleKernel* kernels, const std::uint32_t* list, std::size_t count,
                const float* origin, float cell, float* values);
  /// The field at `count` points, a whole number of sixteens.
  void (*points)(const ParticleKernel* kernels, const std::uint32_t* list, std::size_t count,
                 const FieldPoints& points, std::size_t point_count);
};

/// One lane after the other, to compare with.
struct PlainLanes;

template <class Isa>
const SurfaceKernels& surface_kernels();

/// Those of an instruction set; scalar code where there are none. Results are the same.
const SurfaceKernels& find_surface_kernels(InstructionSet set);

}  // namespace souple::kernels
