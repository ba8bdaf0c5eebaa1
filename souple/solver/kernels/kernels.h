#pragma once

#include "souple/constraints/kinds.h"

#include <cstddef>
#include <cstdint>
#include <tuple>
#include <type_traits>

// The interface of the kernels of every instruction set: plain pointers, no containers.

namespace souple::kernels {

/// A Column (constraints/column.h): value i is at values[i * stride], stride 0 or 1.
struct ColumnView {
  const float* values = nullptr;
  std::size_t stride = 0;
};

/// Particles as kernels access them: arrays of 16-byte records (see ParticleView).
struct ParticleArrays {
  const float* position = nullptr;  ///< w = inverse mass
  const float* moving = nullptr;    ///< displacements
  float* corrected = nullptr;       ///< corrections are added here: `moving`, a separate array, or velocities
};

/// A ConstraintSet and the parameters of the substep.
struct SetArrays {
  const std::uint32_t* const* records = nullptr;  ///< [arity], each [i]: 4 times the particle
  const ColumnView* parameters = nullptr;         ///< [floats in Params]
  const ColumnView* compliances = nullptr;        ///< [compliance_size]
  ColumnView damping_time, scale;                 ///< scale: factor of every correction
  ColumnView half_shared;                         ///< phi / 2, see projection.h
  float* const* multipliers = nullptr;            ///< [rows], each [i]; null: not stored
  float h = 0;                                    ///< s
  float inverse_h2 = 0;                           ///< 1 / h^2; 0 in PBD mode
  float relaxation = 1;                           ///< factor of every correction, besides `scale`
  float sweep_share = 0;                          ///< forces only: see elastic_forces in projection.h
};

/// Projects constraints [begin, end), which share no particle.
using Project = void (*)(const ParticleArrays&, const SetArrays&, std::size_t begin, std::size_t end);
/// C of constraints [begin, end): values[row][i - begin].
using Evaluate = void (*)(const ParticleArrays&, const SetArrays&, std::size_t begin, std::size_t end,
                          float* const* values);

/// The kernels of one kind for one instruction set.
struct KindKernels {
  Project plain;    ///< no multipliers, corrections in place
  Project general;  ///< all terms
  Project damp;     ///< `corrected` are velocities
  Evaluate evaluate;
  Project forces;  ///< adds elastic forces times h^2 to `corrected`; null for kinds without softness
};

/// Compiled in one translation unit per instruction set (compile.h).
template <class Isa, class Kind>
const KindKernels& kind_kernels();

namespace detail {
template <class Kind, class List>
inline constexpr bool contains = false;
template <class Kind, class... Kinds>
inline constexpr bool contains<Kind, std::tuple<Kinds...>> = (std::is_same_v<Kind, Kinds> || ...);
}  // namespace detail

/// Whether a kind has compiled kernels. The CMake function souple_add_constraints compiles a user's own kinds
/// and specializes this for them.
template <class Kind>
inline constexpr bool is_compiled = detail::contains<Kind, EveryConstraint>;

}  // namespace souple::kernels
