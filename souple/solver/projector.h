#pragma once

#include "souple/math/elementary.h"
#include "souple/math/index_range.h"
#include "souple/solver/modes.h"
#include "souple/state/particles.h"
#include "souple/threads/threads.h"

#include <cmath>
#include <cstdint>
#include <functional>
#include <span>
#include <string_view>
#include <vector>

namespace souple {

class ExternalMoves;
class LeftOut;
class SweepRegions;

inline constexpr std::uint32_t no_particle = ~std::uint32_t{0}, unknown_particle = no_particle - 1;

/// Constraints [begin, end) of a color of a projector.
struct SweptRun {
  int color = 0;
  std::size_t begin = 0, end = 0;
};

/// The current substep.
struct Substep {
  float h = 0;         ///< length [s]
  int iterations = 1;  ///< per substep
  Mode mode = Mode::small_steps;
  int count = 1;   ///< substeps per step
  int number = 0;  ///< of this one in its step
  int sweep = 0;   ///< number of the present sweep in its step
  /// Factor of every correction and its multiplier (above 1: over-relaxation), constant from begin_substep
  /// on. Only solvers that sweep use it. Contacts ignore it.
  float relaxation = 1;
  /// Particles of objects on which no coarser levels act, ascending. While intersections are resolved they must not: they
  /// pull back what is separated.
  std::span<const IndexRange> without_levels{};
  ExternalMoves* external = nullptr;  ///< records the sweeps of this substep; null: not needed
  const LeftOut* left_out = nullptr;  ///< constraints that sweeps omit; null: none
  const LeftOut* asleep = nullptr;    ///< constraints that would move nothing; null: none
  SweepRegions* regions = nullptr;    ///< null: all constraints are swept equally often

  /// With one sweep per iteration.
  int first_sweep() const { return number * iterations; }
  bool stores_multipliers() const {
    return mode == Mode::xpbd || (mode == Mode::small_steps && iterations > 1);
  }
};

/// PBD mode: k' of each of n iterations that together have the stiffness k. Müller et al. 2007, section 3.3.
inline float stiffness_per_iteration(float k, int n) {
  return 1 - static_cast<float>(elementary::pow(double{1 - k}, 1.0 / n));
}

/// The particles that a projector reads and moves (see state/particles.h). Projectors write to `moving` only.
struct ParticleView {
  std::span<const Vec4f> position;  ///< constant during a substep; w = inverse mass
  std::span<Vec4f> moving;          ///< displacements; w is not changed
  std::span<const Vec4f> start;     ///< `moving` at the start of the substep
  /// Array that corrections are added to; empty: `moving`, as in Gauss-Seidel.
  std::span<Vec4f> corrected{};

  float inverse_mass(std::size_t i) const { return position[i].w; }

  /// The first of these particles that can move; no_particle if none can.
  template <class Indices>
  std::uint32_t first_movable(const Indices& indices) const {
    for (const std::uint32_t i : indices)
      if (position[i].w > 0) return i;
    return no_particle;
  }
  /// x_i - origin, without the rounding error of a large x_i. [m]
  Vec3f relative(std::size_t i, const Vec3f& origin) const {
    return position[i].xyz() - origin + moving[i].xyz();
  }
  /// x_i - x_j. [m]
  Vec3f difference(std::size_t i, std::size_t j) const {
    return (position[i].xyz() - position[j].xyz()) + (moving[i].xyz() - moving[j].xyz());
  }
  /// x_i in double: far from the origin no part of its displacement is lost. [m]
  Vec3d exact_position(std::size_t i) const { return exact_sum(position[i], moving[i]); }
  /// x_i at the start of the substep. [m]
  Vec3d exact_start(std::size_t i) const { return exact_sum(position[i], start[i]); }
  /// Displacement of particle i since the start of the substep. [m]
  Vec3f moved(std::size_t i) const { return moving[i].xyz() - start[i].xyz(); }
  /// Adds a correction. [m]
  void correct(std::size_t i, const Vec3f& dx) const {
    Vec4f& m = (corrected.empty() ? moving : corrected)[i];
    m.x += dx.x, m.y += dx.y, m.z += dx.z;
  }
};

/// Violation of constraints, in the unit of their C. Inequalities count only when violated.
struct Residual {
  double largest = 0;
  double sum = 0;  ///< of absolute values; divide by count for the mean
  std::size_t count = 0;
  double energy = 0;          ///< 1/2 C^T alpha^-1 C of the constraints with compliance [J]
  double largest_strain = 0;  ///< (l - l0) / l0, extension only; for kinds that have a strain

  /// Adds the residual of further constraints.
  void add(const Residual& other) {
    largest = max(largest, other.largest);
    sum += other.sum;
    count += other.count;
    energy += other.energy;
    largest_strain = max(largest_strain, other.largest_strain);
  }
};

/// Current state of one constraint, for display.
struct ConstraintState {
  std::span<const std::uint32_t> particles;  ///< valid during the call
  int color = 0;
  float strain = 0;    ///< (l - l0) / l0 of kinds that have a strain, else 0
  float residual = 0;  ///< largest |C| of its rows, in the unit of C; 0 for a satisfied inequality
};
using ConstraintVisitor = std::function<void(const ConstraintState&)>;

class ElasticFacet;
class ErrorFacet;
class LinearFacet;
class MemoryFacet;
class StructureFacet;
class StudyFacet;
struct NeoHookean;
template <class Kind>
class SetProjector;

/// The constraints keep objects apart.
class ContactFacet {
 public:
  /// Whether they keep objects out of colliders: each moves particles of one object only.
  virtual bool is_collider_contact() const { return false; }
  /// Calls f(particle) where an overlap that existed before is being removed slowly.
  virtual void visit_overlaps(const std::function<void(std::uint32_t)>&) const {}
  /// Takes the constraints whose particle is chosen, chosen[i] != unchosen, for project_some until put_back_some.
  /// Appends their particles to `taken`. The default takes none.
  virtual void take_some([[maybe_unused]] std::span<const std::uint32_t> chosen,
                         [[maybe_unused]] std::vector<std::uint32_t>& taken) {}
  static constexpr std::uint32_t unchosen = ~std::uint32_t{0};
  /// Projects them. `again`: particles have hardly moved since the last projection, so that it may use the gradients
  /// found there.
  virtual void project_some(const ParticleView&, [[maybe_unused]] bool again) {}
  virtual void put_back_some() {}

 protected:
  ~ContactFacet() = default;
};

/// Abilities of a projector beyond those that every solver needs (solver/facets.h). Null: it lacks the ability.
struct Facets {
  std::size_t grain = 1;     ///< minimum number of constraints per thread
  bool every_round = false;  ///< projected in every round of sweeps, as contacts are
  bool alternates = false;   ///< every second sweep takes the colors in reverse order
  ContactFacet* contact = nullptr;
  ElasticFacet* elastic = nullptr;
  ErrorFacet* errors = nullptr;
  const LinearFacet* linear = nullptr;
  const MemoryFacet* memory = nullptr;
  // Constraints that are links, distances, attachments or bendings; see StructureFacet.
  const StructureFacet* links = nullptr;
  const StructureFacet* distances = nullptr;
  const StructureFacet* attachments = nullptr;
  const StructureFacet* bendings = nullptr;
  SetProjector<NeoHookean>* tets = nullptr;  ///< the one kind that TetLevels know
  StudyFacet* study = nullptr;
};

/// The interface between solvers and constraints: moves particles towards satisfying its constraints. Solvers
/// call it per set and color, never per constraint. Constraints of one color share no particle. So their order within a
/// color is free, and parts of a color may be projected at the same time.
class Projector {
 public:
  virtual ~Projector() = default;

  virtual std::string_view kind() const = 0;
  virtual std::size_t size() const = 0;
  /// Sorts, colors and allocates. Call after constraints were added or erased and before the next substep.
  virtual void prepare(std::size_t particle_count) = 0;
  virtual int color_count() const = 0;
  /// Number of constraints of a color.
  virtual std::size_t color_size(int color) const = 0;
  /// A particle that the constraint moves; no_particle if none can move. By default it is unknown: while there is such a
  /// projector, all constraints are swept equally often.
  virtual std::uint32_t particle_of([[maybe_unused]] int color, [[maybe_unused]] std::size_t index,
                                    const ParticleView&) const {
    return unknown_particle;
  }
  virtual void begin_substep(const ParticleView&, const Substep&) {}
  /// Projects constraints [begin, end) of a color. Other parts of the color may be projected at the same
  /// time.
  virtual void project(int color, std::size_t begin, std::size_t end, const ParticleView&,
                       const Substep&) = 0;
  /// With `threads`, for the report of a step: it may omit the energy, and may use all of them.
  virtual Residual residual(const ParticleView&, Threads* threads = nullptr) const = 0;
  /// Calls the visitor for each constraint, color after color. The default visits none.
  virtual void visit(const ParticleView&, const ConstraintVisitor&) const {}
  /// Removes the constraints of particles [begin, end), which cease to exist, and renumbers the others.
  virtual void erase_particles(std::uint32_t begin, std::uint32_t end) = 0;
  /// The default has none.
  virtual Facets facets() { return {}; }

  /// Projects a whole color.
  void project(int color, const ParticleView& particles, const Substep& substep) {
    project(color, 0, color_size(color), particles, substep);
  }
};

}  // namespace souple
