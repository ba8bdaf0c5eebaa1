#pragma once

#include "souple/collision/collider_motion.h"
#include "souple/collision/shapes.h"
#include "souple/math/transform.h"

#include <cstdint>
#include <limits>

namespace souple {

/// A round nozzle that emits fluid in layers, one spacing apart. With the spacing d, a layer consists of the points of
/// a square lattice of pitch d within `radius`. These are about N = pi radius^2 / d^2 points (one if the radius is
/// below d). The flow is N d^2 speed [m^3/s].
///
/// The inflow zone is the first two spacings from the nozzle. Fluid of this object that moves with the jet is kinematic
/// there and goes straight on, as in a pipe. After that it is free. A particle is held back where other fluid is too
/// near, or when the object is at its capacity (ObjectOptions::max_particles). A full closed vessel holds all
/// back: the pressure at the nozzle exceeds that of its depth by rho (d / (6 h))^2, with the substep h.
struct Emitter {
  Vec3f position{};                                      ///< center of the nozzle [m]
  Vec3f direction{0, -1, 0};                             ///< direction of the flow; any length but zero
  float radius = 0.05f;                                  ///< m
  float speed = 1;                                       ///< m/s
  double start = 0;                                      ///< time of the first layer [s]
  double end = std::numeric_limits<double>::infinity();  ///< no layer from this time on [s]
  /// Its poses are applied to the position and the direction. The fluid adopts the nozzle's velocity.
  ColliderMotion motion{};
};

/// A region that removes fluid particles.
struct Drain {
  Shape shape{};                                         ///< a plane removes the fluid below it
  Transform pose{};                                      ///< pose of the shape
  float rate = std::numeric_limits<float>::infinity();   ///< upper limit [m^3/s]
  double start = 0;                                      ///< opening time [s]
  double end = std::numeric_limits<double>::infinity();  ///< closing time [s]
};

/// Handles, like those of objects.
struct EmitterId {
  std::uint32_t value = 0;
};
struct DrainId {
  std::uint32_t value = 0;
};

}  // namespace souple
