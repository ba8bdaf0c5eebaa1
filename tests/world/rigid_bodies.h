#pragma once

#include "souple/geometry/builders.h"
#include "souple/world/world.h"

// Helpers that tests of rigid bodies in worlds share.

namespace souple {

inline ObjectOptions at(double x, double y, double z) {
  ObjectOptions options;
  options.transform.translation = {x, y, z};
  return options;
}

inline const Box small_box{{}, {0.1f, 0.1f, 0.1f}};

inline void run(World& world, double seconds) {
  for (int frame = 0; frame < seconds * 60; ++frame) world.step(1.0f / 60);
}

inline World without_gravity() {
  World world;
  Settings settings = world.settings();
  settings.gravity = {};
  world.set_settings(settings);
  return world;
}

}  // namespace souple
