#pragma once

#include "souple/geometry/builders.h"
#include "souple/io/recorder.h"
#include "souple/world/world.h"

#include <string>
#include <vector>

namespace souple::test {

/// One object of each kind, all falling and swinging.
inline World everything() {
  World world({.substeps = 4});
  const ObjectId cloth = world.add_cloth(grid(6, 5, 1), {}, {.name = "flag"});
  world.pin(cloth, vertices({0, 5}));
  world.add_soft_body(box({0.3, 0.3, 0.3}, {2, 2, 2}), {}, {.cells = 60},
                      {.name = "jelly", .transform = {.translation = {2, 1, 0}}});
  const std::vector<Vec3d> line{{-2, 1, 0}, {-1, 1, 0}};
  world.add_rope(line, 6, {}, {.name = "line"});
  const std::vector<Vec3d> centers{{0, 2, 0}, {0.5, 2, 0}, {0, 2, 0.5}};
  world.add_grains(centers, {}, {.name = "sand"});
  world.add_collider(Plane{.normal = {0, 1, 0}, .offset = 0});
  return world;
}

/// Positions by frame and object.
using Shown = std::vector<std::vector<std::vector<Vec3f>>>;

/// Steps and captures; returns what the world showed.
inline Shown run(World& world, Recorder& recorder, int frames) {
  Shown shown;
  for (int i = 0; i < frames; ++i) {
    world.step(1.0 / 60);
    recorder.capture();
    auto& objects = shown.emplace_back();
    for (const ObjectId object : world.objects())
      objects.emplace_back(world.positions(object).begin(), world.positions(object).end());
  }
  return shown;
}

/// A run into a folder, from its first frame to its last.
inline Shown record(World& world, const std::string& folder, int frames,
                    const RecorderOptions& options = {}) {
  Recorder recorder(world, folder, options);
  Shown shown = run(world, recorder, frames);
  recorder.finish();
  return shown;
}

}  // namespace souple::test
