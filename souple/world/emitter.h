#pragma once

#include "souple/collision/collider_motion.h"
#include "souple/collision/shapes.h"
#include "souple/math/transform.h"

#include <cstdint>
#include <limits>

namespace souple {

/// A round nozzle from which a fluid comes, layer after layer, a spacing apart. With d the spacing, a layer
/// is of the points of a square lattice of d within `radius`, about N = pi radius^2 / d^2 of them (one where
/// the radius is below d), and N d^2 speed is the flow [m^3/s].
///
/// In the first two spacings before it, the mouth, fluid of this object that goes with the jet is led
/// straight on as in a pipe; from there on it is free. Where there is fluid already, or no room in its object
/// (ObjectOptions::max_particles), particles are held back.
struct Emitter {
  Vec3f position{};                                      ///< of its middle [m]
  Vec3f direction{0, -1, 0};                             ///< where the fluid goes; any length but zero
  float radius = 0.05f;                                  ///< m
  float speed = 1;                                       ///< m/s
  double start = 0;                                      ///< when the first layer comes [s]
  double end = std::numeric_limits<double>::infinity();  ///< none comes from here on [s]
  /// Its poses are applied to the position and the direction; the fluid takes over its velocity.
  ColliderMotion motion{};
};

/// A region in which fluids cease to exist.
struct Drain {
  Shape shape{};                                         ///< a plane takes what is below it
  Transform pose{};                                      ///< where the shape stands
  float rate = std::numeric_limits<float>::infinity();   ///< at most so much a second [m^3/s]
  double start = 0;                                      ///< when it opens [s]
  double end = std::numeric_limits<double>::infinity();  ///< when it closes [s]
};

/// Handles, as those of objects.
struct EmitterId {
  std::uint32_t value = 0;
};
struct DrainId {
  std::uint32_t value = 0;
};

}  // namespace souple
