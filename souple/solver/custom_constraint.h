#pragma once

#include "souple/constraints/constraint.h"
#include "souple/solver/facets.h"
#include "souple/solver/particle_groups.h"
#include "souple/solver/scalar_projection.h"

#include <functional>
#include <limits>
#include <memory>
#include <string>

namespace souple {

/// A constraint defined at run time on any number of particles: one scalar C(x) and its gradient. If the
/// number of particles is known at compile time, a struct (constraints/constraint.h) is faster.
class CustomConstraint {
 public:
  virtual ~CustomConstraint() = default;

  /// The particles of the constraint; read once, by `add`.
  virtual std::span<const std::uint32_t> particles() const = 0;
  /// C at positions x [m], measured from `origin`; x[k] belongs to particles()[k]. Fills `gradient` (zero at
  /// entry) with dC/dx[k]. If it throws or returns a non-finite value, the constraint is skipped and the
  /// reason recorded.
  virtual float evaluate(std::span<const Vec3f> x, std::span<Vec3f> gradient) = 0;
  /// Reference point of the positions [m, world]: a point near the particles keeps float digits.
  virtual Vec3f origin() const { return {}; }

  std::string name = "custom";    ///< for messages
  Sense sense = Sense::equality;  ///< or non_negative: satisfied while C >= 0
  float compliance = 0;           ///< alpha [(unit of C)^2 / J]
  float damping_time = 0;         ///< s
  float stiffness = 1;            ///< PBD mode only: k in [0, 1]
  /// Whether `evaluate` may run on several threads, concurrently with other constraints.
  bool concurrent = false;
};

/// A custom constraint from a function.
class CallbackConstraint final : public CustomConstraint {
 public:
  using Function = std::function<float(std::span<const Vec3f> x, std::span<Vec3f> gradient)>;

  CallbackConstraint(std::vector<std::uint32_t> particles, Function function)
      : particles_(std::move(particles)), function_(std::move(function)) {}

  std::span<const std::uint32_t> particles() const override { return particles_; }
  float evaluate(std::span<const Vec3f> x, std::span<Vec3f> gradient) override {
    return function_(x, gradient);
  }

 private:
  std::vector<std::uint32_t> particles_;
  Function function_;
};

/// Custom constraints behind the Projector interface, by the formulas of projection.h. Errors of user code, except out
/// of memory, never leave a step. If an evaluation throws, or if C, its gradient or the correction is not finite, no
/// particle moves and a message is recorded. The next evaluation tries again.
class CustomProjector final : public GroupProjector, public ErrorFacet {
 public:
  /// Throws Error when the constraint is null, has no particles or one twice, or a number is out of range.
  /// `prepare` must follow before the next substep. Settings of the constraint may change between steps; its
  /// particles may not.
  void add(std::shared_ptr<CustomConstraint> constraint);

  /// The first error since the last call, empty if there was none: "custom constraint 'name': ...".
  std::string take_error() override;

  std::string_view kind() const override { return "custom"; }
  void begin_substep(const ParticleView& particles, const Substep& substep) override;
  Facets facets() override { return {.grain = grain(), .elastic = this, .errors = this}; }
  Residual residual(const ParticleView& particles, Threads* = nullptr) const override;
  void visit(const ParticleView& particles, const ConstraintVisitor& visitor) const override;
  void erase_particles(std::uint32_t begin, std::uint32_t end) override;

 private:
  struct Item {
    std::shared_ptr<CustomConstraint> constraint;
    double multiplier = 0;
    std::vector<Vec3f> position, gradient;  // scratch
    std::string error;                      // per constraint, so that threads do not share it
  };

  /// All constraints of a color on one thread, unless all constraints are concurrent.
  std::size_t grain() const { return concurrent_ ? 1 : std::numeric_limits<std::size_t>::max(); }
  static bool evaluate(Item& item, std::span<const std::uint32_t> group, const ParticleView& particles,
                       float& C);
  void project_one(std::size_t i, const ParticleView& particles, const Substep& substep) override;
  void damp_one(std::size_t i, const ParticleView& particles, std::span<Vec4f> velocity,
                const Substep& substep) override;

  bool concurrent_ = true;
  mutable std::vector<Item> items_;  // `residual` writes the scratch arrays and may record an error
};

}  // namespace souple
