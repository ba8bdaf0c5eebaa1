#pragma once

#include "souple/collision/segment_triangle/choice.h"
#include "souple/fluid/foam_parameters.h"
#include "souple/fluid/smoothing_shape.h"
#include "souple/math/vec3.h"
#include "souple/solver/projector.h"
#include "souple/solver/solver.h"

#include <cstdint>

namespace souple {

/// Stage (1). Semi-implicit is the default; the others exist to compare (docs/integrators.md).
enum class Integrator {
  semi_implicit,   ///< v* = v + h w f(x, v),   p* = x + h v*
  explicit_euler,  ///< p* = x + h v,           v* = v + h w f(x, v)
  implicit_euler   ///< v* = v + h w f(p*, v*), p* = x + h v*   (implicit in the external forces)
};

/// Moving air. Acts on triangles (drag and lift per area) and, with the linear drag of Settings, on
/// particles.
struct Wind {
  Vec3f velocity{};            ///< m/s
  float gust = 0;              ///< the wind's strength varies by this fraction, in [0, 1]
  float gust_period = 2;       ///< s, of the slowest of the gusts
  float air_density = 1.225f;  ///< kg/m^3
  friend bool operator==(const Wind&, const Wind&) = default;
};

/// How fluids are kept from being compressed (docs/fluids.md).
struct FluidSettings {
  SmoothingShape kernel = SmoothingShape::wendland;
  /// Jacobi iterations after the coarse level, 0 to 100. With 0 the substep costs half; its residual is added
  /// to the coarse level's pressure.
  int iterations = 1;
  float tolerance = 0;        ///< > 0: more iterations, up to 50, until the mean density error is below it
  float compressibility = 0;  ///< fluids are denser by this times their pressure, >= 0 [1/Pa]
  /// Pressure with which two particles push each other that are 0.4 spacings apart, >= 0 [Pa]
  float artificial_pressure = 0;
  FoamParameters foam{};  ///< of fluids whose material's `foam` is above 0
  friend bool operator==(const FluidSettings&, const FluidSettings&) = default;
};

/// Objects at rest fall asleep: they stay where they are to the bit, cost little, and hold what lies on them.
/// They wake when something moves them or near them (docs/collisions.md).
struct Sleeping {
  bool enabled = false;
  float speed = 0.03f;   ///< of an object at rest no particle goes farther in a step than this times dt [m/s]
  float seconds = 0.5f;  ///< of rest before it falls asleep, > 0
  friend bool operator==(const Sleeping&, const Sleeping&) = default;
};

/// How a world is simulated. All of it may be changed between steps.
struct Settings {
  int substeps = 10;   ///< per step, >= 1
  int iterations = 1;  ///< of the solver per substep, >= 1
  Mode mode = Mode::small_steps;
  Form form = Form::displacement;
  Integrator integrator = Integrator::semi_implicit;
  Vec3f gravity{0, -9.81f, 0};  ///< m/s^2
  Wind wind{};
  float drag = 0;                 ///< linear drag: f = -drag m (v - wind)  [1/s]
  bool measure_residuals = true;  ///< residuals and strain in the report: costs about one iteration a step
  std::uint64_t seed = 1;         ///< of the gusts, and of where fluids foam
  SolverSettings solver{};
  FluidSettings fluid{};
  Sleeping sleeping{};
  SegmentTest segment_test = default_segment_test;  ///< of rays against surfaces (docs/segment-triangle.md)
  int threads = 0;  ///< results do not depend on it; 0: one for each processor
  Threading threading = Threading::automatic;
};

}  // namespace souple
