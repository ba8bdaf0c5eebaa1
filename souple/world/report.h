#pragma once

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

/// Warnings of a step. `advice` names the setting that helps.
enum class Flag : std::uint32_t {
  /// A position or velocity became NaN or infinite; the last valid state was restored.
  non_finite = 1u << 0,
  /// An edge or a membrane is stretched by more than 10 %. Not converged: raise substeps, a higher
  /// stiffness changes little. Converged: raise the stiffness, or lower the load. Unless the stretch
  /// is intended. Tets are left out: soft bodies are meant to deform.
  large_strain = 1u << 1,
  /// A contact is deeper than the largest thickness after the step: raise substeps or the thickness.
  deep_contact = 1u << 2,
  /// A user's callback threw; its effect was left out.
  callback_failed = 1u << 3,
  /// Edges pass through triangles, and the step resolves them gradually: start without intersections.
  intersecting = 1u << 4,
  /// A fluid is too deep or too fast for its spacing and the substep: raise substeps.
  coarse_substeps = 1u << 5,
  /// The deformation of an object needs forces far larger than those that it carries (ObjectReport):
  /// raise substeps, or use the solver `automatic`. The message names the object.
  not_converged = 1u << 6
};
/// One line: meaning of the flag and the setting that helps.
std::string_view advice(Flag flag);

struct KindReport {
  std::string_view kind;  ///< "distance", "neo_hookean", ...
  std::size_t count = 0;  ///< constraints
  /// Max |C| at the end of the step, in the unit of C; for inequalities only violations count.
  double largest = 0;
  double mean = 0;
  double largest_strain = 0;  ///< (l - l0) / l0, extension only; 0 for kinds that measure none
};

/// Balance of the forces of a cloth, soft body or rope after the last solve of a step (world/balance.h states the
/// formulas). Both are 0 in equilibrium, at rest and in motion, however soft the material. Each object is measured every
/// sixteenth step; until then, and asleep, the values stay.
struct ObjectReport {
  std::string name;
  /// Force out of balance, relative to elastic force, carried force and weight: 0 to 1. Stiff cloth has 0.1 to 0.7
  /// where it looks converged, because a strain of 0.01 % already balances it.
  double unbalanced = 0;
  double stretch = 0;  ///< (l - l0) / l0 by which a uniform motion of the object would restore the balance
};

/// Results of a step for fluids. Density errors are max(0, C) with C = rho / rho_0 - 1, before the last
/// correction of the last substep.
struct FluidReport {
  std::size_t particles = 0;
  std::size_t emitted = 0, drained = 0;  ///< particles added and removed before the step
  std::size_t held_back = 0;  ///< particles that an emitter could not add: blocked by fluid, or no capacity
  double mean_density_error = 0, largest_density_error = 0;
  double largest_pressure = 0;   ///< Pa
  double fastest = 0;            ///< largest speed [m/s]
  double largest_step = 0;       ///< max of h max(sqrt(p / rho), v / 1.5) / spacing; should be below a third
  double iterations = 0;         ///< Jacobi iterations, mean over the substeps
  double coarse_iterations = 0;  ///< conjugate gradient iterations for the pressure, mean over the substeps
  /// Conjugate gradient iterations for the viscosity, mean over the substeps; 0 if no system is solved.
  double viscosity_iterations = 0;
  std::size_t spray = 0, foam = 0, bubbles = 0;  ///< particles at the end of the step
};

/// Results of a step. World::step returns it; it stays valid until the next step.
struct StepReport {
  std::uint64_t step = 0;  ///< counted from 1
  double time = 0;         ///< s, at the end of the step
  int substeps = 0, iterations = 0;
  std::array<double, stage_count> milliseconds{};  ///< per Stage
  std::size_t particles = 0, constraints = 0;
  std::size_t contacts = 0;  ///< contacts that applied a correction in the last substep
  std::size_t asleep = 0;    ///< objects, at the end of the step
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
  std::string message;           ///< one line for each flag that is set

  bool has(Flag flag) const { return (flags & static_cast<std::uint32_t>(flag)) != 0; }
  bool ok() const { return !has(Flag::non_finite); }
  double total_milliseconds() const {
    double sum = 0;
    for (const double ms : milliseconds) sum += ms;
    return sum;
  }
};

}  // namespace souple
