#pragma once

#include "souple/solver/projector.h"

#include <array>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

// Abilities of projectors beyond those that every solver needs. A projector returns its own facets (Projector::facets).

namespace souple {

struct Coloring;

/// The constraints have the stiffness and the damping of a material.
class ElasticFacet {
 public:
  /// Finds what sweeps without stored multipliers need to be as compliant as the material (see
  /// kernels/projection.h). Call after `prepare` and when inverse masses changed. Without it sweeps are softer.
  virtual void prepare_sweeps(const ParticleView&, [[maybe_unused]] bool masses_changed) {}
  /// Number of sweeps that reach the stiffness of the material from lambda = 0, each with that many times the
  /// compliance. It is at least 1 and at most max_sweeps.
  virtual int sweeps_needed(const Substep&) const { return 1; }
  /// Likewise, of the constraints of some ranges of particles alone.
  virtual int sweeps_needed(const Substep&, std::span<const IndexRange>) const { return 1; }
  /// With fewer than 10 substeps a step, their sweeps make up for them: up to 360 a step.
  static int max_sweeps(const Substep& substep) { return substep.count < 10 ? 360 / substep.count : 10; }
  /// Damps the constraints that have a damping time: changes velocities, after the substep (see
  /// kernels/projection.h).
  virtual void damp(const ParticleView&, std::span<Vec4f> velocity, const Substep&, Threads&) = 0;

 protected:
  ~ElasticFacet() = default;
};

/// Sweeps that a projector needs; 1 without the facet.
inline int sweeps_needed(Projector& projector, const Substep& substep) {
  const ElasticFacet* const elastic = projector.facets().elastic;
  return elastic != nullptr ? elastic->sweeps_needed(substep) : 1;
}

/// The constraints may fail: they call functions of users.
class ErrorFacet {
 public:
  /// The first error since the last call; empty: none.
  virtual std::string take_error() = 0;

 protected:
  ~ErrorFacet() = default;
};

/// One constraint linearized at the current positions, for solvers of the global system:
///   C(x + dx) = C + sum_k gradient_k . dx_k.
struct LinearConstraint {
  std::span<const std::uint32_t> particles;  ///< [arity]; spans are valid during the call
  std::span<const float> C;                  ///< [rows]
  std::span<const Vec3f> gradient;           ///< [row * arity + k]
  std::span<const float> alpha;              ///< alpha / h^2, packed lower triangle of rows x rows; 0 in PBD
  float scale = 1;                           ///< PBD: k' = 1 - (1 - k)^(1/n); otherwise 1
  bool inequality = false;                   ///< satisfied while C >= 0
};
using LinearVisitor = std::function<void(const LinearConstraint&)>;

/// The constraints can be linearized. Contacts, shape matching, enclosed volumes and custom constraints cannot; solvers
/// of a global system project them instead.
class LinearFacet {
 public:
  /// Calls the visitor for each constraint, in an order that changes only in `prepare`.
  virtual void linearize(const ParticleView&, const Substep&, const LinearVisitor&) const = 0;
  /// Calls the visitor for the constraints of the given numbers, in their order: numbers as `linearize` counts them.
  virtual void linearize_some(std::span<const std::uint32_t>, const ParticleView&, const Substep&,
                              const LinearVisitor&) const = 0;
  /// Appends ranges of constraints, as `linearize` counts them, that concern only the given ranges of particles; both
  /// ascending and disjoint, none of two colors. Each constraint is of one object, each range of particles consists of
  /// whole objects. May omit some.
  virtual void append_constraints_of(std::span<const IndexRange>, std::vector<IndexRange>& out) const = 0;

 protected:
  ~LinearFacet() = default;
};

class MemoryFacet {
 public:
  /// Heap memory of the constraints. [bytes]
  virtual std::size_t bytes() const = 0;

 protected:
  ~MemoryFacet() = default;
};

/// A distance that the material keeps, as levels use it.
struct Link {
  std::uint32_t a = 0, b = 0;
  float length = 0;     ///< at rest, along the material [m]
  float energy = 0;     ///< k l^2, twice the energy at strain 1 [J]; infinite if rigid
  float stiffness = 1;  ///< PBD mode: k in [0, 1]

  /// alpha [m/N]; 0 if rigid
  float compliance() const { return length * length / energy; }
  bool operator==(const Link&) const = default;
};

/// Structure of constraints for levels and exact solvers (multilevel/). constraints/constraint.h says how a kind states
/// it.
class StructureFacet {
 public:
  /// A distance: C = |x_0 - x_1| - rest_length; an attachment: C = |x_0 - target|.
  struct Pull {
    std::array<std::uint32_t, 2> particle{};
    float compliance = 0;   ///< [m/N]
    float rest_length = 0;  ///< [m]
    Vec3f target{};         ///< [m]
  };
  /// A bending: to first order C = |sum_k K_k x_k|.
  struct Bending {
    std::array<std::uint32_t, 4> particle{};
    std::array<float, 4> K{};
    float compliance = 0;  ///< 0: rigid, or not flat at rest
  };

  /// Changes whenever constraints may have; no two projectors ever have the same, not even one that is built at the
  /// address of another.
  virtual std::uint64_t revision() const = 0;
  /// Appends the links of constraints [begin, end).
  virtual void append_links(std::size_t begin, std::size_t end, std::vector<Link>& out) const = 0;
  virtual Pull pull(std::size_t i) const = 0;
  virtual Bending bending(std::size_t i) const = 0;

 protected:
  ~StructureFacet() = default;
};

/// Data that studies (studies/) read and change.
class StudyFacet {
 public:
  /// Visits the multipliers stored in this substep, for solvers that extrapolate them with the positions.
  virtual void multipliers(const std::function<void(std::span<float>)>&) = 0;
  /// Number of particles of each constraint, and their indices, constraint by constraint, in order of color.
  virtual int arity() const = 0;
  virtual std::vector<std::uint32_t> indices() const = 0;
  virtual std::span<const std::uint32_t> color_begin() const = 0;
  /// Sorts and colors the constraints again. `project` then acts on `particles` (phantoms, studies/partition.h), in that
  /// order, in the place of those of the constraints; all other functions still name the latter.
  virtual void replace(Coloring coloring, std::span<const std::uint32_t> particles) = 0;
  /// Takes `replace` back.
  virtual void restore() = 0;

 protected:
  ~StudyFacet() = default;
};

}  // namespace souple
