#pragma once

#include "souple/collision/detection.h"
#include "souple/fluid/fluid_settings.h"
#include "souple/math/vec3.h"
#include "souple/solver/modes.h"
#include "souple/solver/solver_settings.h"
#include "souple/threads/threads.h"

#include <cstdint>

namespace souple {

/// Integrator of stage (1). The default is semi-implicit; the others exist for comparison
/// (docs/integrators.md).
enum class Integrator {
  semi_implicit,   ///< v* = v + h w f(x, v),   p* = x + h v*
  explicit_euler,  ///< p* = x + h v,           v* = v + h w f(x, v)
  implicit_euler   ///< v* = v + h w f(p*, v*), p* = x + h v*   (implicit in the external forces)
};

/// Air, still or moving. It acts on the triangles of cloths (drag and lift per area: docs/materials.md, Air) and, through the linear
/// drag of Settings, on particles.
struct Wind {
  Vec3f velocity{};            ///< m/s
  float gust = 0;              ///< relative amplitude of the wind's variation, in [0, 1]
  float gust_period = 2;       ///< period of the slowest gust [s]
  float air_density = 1.225f;  ///< 0: a vacuum [kg/m^3]
  friend bool operator==(const Wind&, const Wind&) = default;
};

/// Objects at rest fall asleep: their positions stay bitwise constant, they cost little and still support
/// other objects. They wake when they or objects near them are moved (docs/collisions.md).
struct Sleeping {
  bool enabled = false;
  float speed = 0.03f;   ///< an object rests if no particle moves farther in a step than this times dt [m/s]
  float seconds = 0.5f;  ///< rest time before an object falls asleep, > 0
  friend bool operator==(const Sleeping&, const Sleeping&) = default;
};

/// Parameters of the simulation. All may change between steps.
struct Settings {
  int substeps = 10;   ///< per step, >= 1
  int iterations = 1;  ///< solver iterations per substep, >= 1
  Mode mode = Mode::small_steps;
  Integrator integrator = Integrator::semi_implicit;
  Vec3f gravity{0, -9.81f, 0};  ///< m/s^2
  Wind wind{};
  float drag = 0;                 ///< linear drag: f = -drag m (v - wind)  [1/s]
  bool measure_residuals = true;  ///< report residuals and strain: costs about one iteration per step
  std::uint64_t seed = 1;         ///< of the gusts and of the spawning of foam
  SolverSettings solver{};
  FluidSettings fluid{};
  Sleeping sleeping{};
  Detection detection = Detection::continuous;  ///< of contacts between surfaces
  /// For rays against surfaces, and for the paths of discrete detection (docs/segment-triangle.md).
  SegmentTest segment_test = default_segment_test;
  /// Does not change results; 0: the environment variable SOUPLE_THREADS, or one for each processor.
  int threads = 0;
  Threading threading = Threading::automatic;
};

}  // namespace souple
