#pragma once

#include "souple/world/world.h"

#include <span>
#include <string>

// The scenes of `souple bench`: a table of scenes that are built by name and size.

namespace souple::app {

struct BenchScene {
  const char* name;
  const char* description;  ///< one line
  const char* size_means;   ///< meaning of --size
  int default_size;
  int least, most;  ///< useful sizes
  /// Fills an empty world.
  void (*build)(World& world, int size);
};

/// All scenes, in the order of the list on screen.
std::span<const BenchScene> bench_scenes();

/// Throws Error with the nearest name.
const BenchScene& find_bench_scene(const std::string& name);

/// The mesh of the scene `cloth`: an upright sheet with row 0 (vertices 0 to size - 1) as its upper rim.
TriangleMesh hanging_grid(int size);

/// Stretches every cloth of a world in both directions about the middle of its upper row, which stays fixed.
/// The stretch along that row begins at zero there, so that the rest shape solves all constraints. `strain`
/// 0.1: 10 %.
void stretch_cloths(World& world, double strain);

}  // namespace souple::app
