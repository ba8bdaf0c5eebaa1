#pragma once

#include "souple/souple.h"

// Helpers for tests of moving particles.

namespace souple {

inline const char* mode_name(Mode mode) {
  return mode == Mode::pbd ? "pbd" : mode == Mode::xpbd ? "xpbd" : "small steps";
}

/// A grain with a mass of `mass` kg.
inline GrainsMaterial grain_of_mass(double mass, float radius = 0.01f) {
  GrainsMaterial material;
  material.radius = radius;
  const auto r = static_cast<double>(radius);
  material.density = static_cast<float>(mass / (4.0 / 3 * pi * r * r * r));
  return material;
}

/// Steps `frames` times; returns false if a value becomes non-finite.
inline bool run(World& world, int frames, double dt) {
  for (int frame = 0; frame < frames; ++frame)
    if (!world.step(dt).ok()) return false;
  return true;
}

}  // namespace souple
