#pragma once

#include "souple/fluid/fluid_report.h"
#include "souple/state/warnings.h"

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace souple {

/// Stages of the loop, in order. `broad_phase` and `foam` run once per step, the others once per substep.
enum class Stage { broad_phase, integrate, fluids, contacts, solve, finish, velocity, foam };
inline constexpr std::size_t stage_count = 8;
std::string_view stage_name(Stage stage);

/// How a step ended. The report's message says why where it is not `done`.
enum class StepOutcome {
  done,      ///< the world is dt later
  refused,   ///< nothing was done: a wrong dt, a solver that cannot take the scene, a call from within a step
  diverged,  ///< a value became non-finite; the state before the step was restored
  abandoned  ///< an exception, such as out of memory, passed through the step and left the world half done
};

std::string_view outcome_name(StepOutcome outcome);

struct KindReport {
  std::string_view kind;  ///< "distance", "neo_hookean", ...
  std::size_t count = 0;  ///< constraints
  /// Max |C| at the end of the step, in the unit of C; for inequalities only violations count.
  double largest = 0;
  double mean = 0;
  double largest_strain = 0;  ///< (l - l0) / l0, extension only; 0 for kinds that measure none
};

/// Balance of the forces of a cloth, soft body or rope after the last solve of a step (stages/balance.h states the
/// formulas). Both are 0 in equilibrium, at rest and in motion, however soft the material. Each object is measured every
/// sixteenth step; until then, and asleep, the values stay.
struct ObjectReport {
  std::string name;
  /// Force out of balance, relative to elastic force, carried force and weight: 0 to 1. Stiff cloth has 0.1 to 0.7
  /// where it looks converged, because a strain of 0.01 % already balances it.
  double unbalanced = 0;
  double stretch = 0;  ///< (l - l0) / l0 by which a uniform motion of the object would restore the balance
};

/// Results of a step. World::step returns it; it stays valid until the next step.
struct StepReport {
  StepOutcome outcome = StepOutcome::done;
  std::uint64_t step = 0;  ///< counted from 1
  double time = 0;         ///< s, at the end of the step
  int substeps = 0, iterations = 0;
  std::array<double, stage_count> milliseconds{};  ///< per Stage
  std::size_t particles = 0, constraints = 0;
  std::size_t contacts = 0;       ///< contacts that applied a correction in the last substep
  std::size_t asleep = 0;         ///< objects, at the end of the step
  std::size_t broken_joints = 0;  ///< joints that broke in the step
  std::size_t broken_ties = 0;    ///< ties that broke in the step
  /// Number of motions that were stopped before two elements would have passed each other.
  std::size_t kept_apart = 0;
  std::size_t intersections = 0;  ///< edges that passed through triangles when the step began
  /// Layer violations when the step began: vertices on the wrong side of another layer, or near one.
  std::size_t layer_violations = 0;
  double deepest_contact = 0;  ///< largest penetration at the end of the step [m]
  /// (l - l0) / l0 over distances, membranes and neo-Hookean tets, extension only.
  double largest_strain = 0;
  FluidReport fluid;
  std::vector<KindReport> kinds;  ///< in order of solution
  /// Cloths, soft bodies and ropes. Empty without Settings::measure_residuals, in PBD mode and with solver colors.
  std::vector<ObjectReport> objects;
  std::uint32_t flags = 0;  ///< bits of Flag
  std::string bad_object;   ///< with Flag::non_finite: object of the first particle with a non-finite value
  std::uint32_t bad_vertex = 0;  ///< with Flag::non_finite: vertex of the first such particle, user order
  std::string message;           ///< one line for each flag that is set, or the reason of a refusal

  bool has(Flag flag) const { return (flags & static_cast<std::uint32_t>(flag)) != 0; }
  bool ok() const { return outcome == StepOutcome::done; }
  double total_milliseconds() const {
    double sum = 0;
    for (const double ms : milliseconds) sum += ms;
    return sum;
  }
};

}  // namespace souple
