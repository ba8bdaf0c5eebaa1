#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace souple {

/// The stages of the loop, in order; `broad_phase` and `foam` run once a step, the others each substep.
enum class Stage { broad_phase, integrate, fluids, contacts, solve, finish, velocity, foam };
inline constexpr std::size_t stage_count = 8;
std::string_view stage_name(Stage stage);

/// What a step wants its user to know. Each names the knob that mends it (see `advice`).
enum class Flag : std::uint32_t {
  non_finite =
      1u
      << 0,  ///< a position or velocity became NaN or infinite; the world was put back to its last good state
  large_strain =
      1u << 1,  ///< an edge is stretched more than 10 %: raise substeps, or compliance is what it should be
  deep_contact = 1u << 2,  ///< a contact ends the step deeper than its thickness: raise substeps or thickness
  callback_failed = 1u << 3,  ///< a user's callback threw; its effect was left out
  intersecting =
      1u << 4,  ///< edges pass through triangles, and are being pulled apart: start with them apart
  coarse_substeps =
      1u << 5  ///< a fluid is too deep or too fast for its spacing and the substep: raise substeps
};
/// One line: what the flag means and which setting mends it.
std::string_view advice(Flag flag);

struct KindReport {
  std::string_view kind;  ///< "distance", "neo_hookean", ...
  std::size_t count = 0;  ///< constraints
  double largest = 0;     ///< |C| at the end of the step, in the unit of C; inequalities only where violated
  double mean = 0;
};

/// What a step did to fluids. Density errors are of C = rho / rho_0 - 1 where that is above 0, before the
/// last correction of the last substep.
struct FluidReport {
  std::size_t particles = 0;
  std::size_t emitted = 0, drained = 0;  ///< particles that came and went before the step
  std::size_t held_back = 0;             ///< that an emitter had no room for
  double mean_density_error = 0, largest_density_error = 0;
  double largest_pressure = 0;      ///< Pa
  double fastest = 0;               ///< m/s
  double largest_step = 0;          ///< h max(sqrt(p / rho), v / 1.5) / spacing, to be below a third
  double iterations = 0;            ///< of Jacobi, mean of the substeps
  double coarse_iterations = 0;     ///< of conjugate gradients for the pressure, mean of the substeps
  double viscosity_iterations = 0;  ///< the same for viscosity; 0 where it is solved without
  std::size_t spray = 0, foam = 0, bubbles = 0;  ///< particles at the end of the step
};

/// What a step did. Returned by World::step; stays valid until the next step.
struct StepReport {
  std::uint64_t step = 0;  ///< counted from 1
  double time = 0;         ///< s, at the end of the step
  int substeps = 0, iterations = 0;
  std::array<double, stage_count> milliseconds{};  ///< per Stage
  std::size_t particles = 0, constraints = 0;
  std::size_t contacts = 0;       ///< that pushed in the last substep
  std::size_t asleep = 0;         ///< objects, at the end of the step
  std::size_t kept_apart = 0;     ///< times that two features were stopped before they passed each other
  std::size_t intersections = 0;  ///< edges that passed through triangles when the step began
  std::size_t layer_violations =
      0;                       ///< vertices on the wrong side of another layer then, or near such a place
  double deepest_contact = 0;  ///< m, penetration left at the end
  double largest_strain = 0;   ///< (l - l0) / l0 over distance constraints, extension only
  FluidReport fluid;
  std::vector<KindReport> kinds;  ///< in the order they are solved
  std::uint32_t flags = 0;        ///< of Flag
  std::string bad_object;         ///< non_finite: which object went bad first
  std::uint32_t bad_vertex = 0;   ///< and which of its vertices, user order
  std::string message;            ///< in words, when a flag is set; one line each

  bool has(Flag flag) const { return (flags & static_cast<std::uint32_t>(flag)) != 0; }
  bool ok() const { return !has(Flag::non_finite); }
  double total_milliseconds() const {
    double sum = 0;
    for (const double ms : milliseconds) sum += ms;
    return sum;
  }
};

}  // namespace souple
