#pragma once

#include "souple/world/world.h"

#include <span>
#include <string>

// The scenes of `souple bench`: one row of a table each, made by name and size.

namespace souple::app {

struct BenchScene {
  const char* name;
  const char* description;  ///< one line
  const char* size_means;   ///< what --size counts
  int default_size;
  int least, most;  ///< sizes that make sense
  /// Fills an empty world.
  void (*build)(World& world, int size);
};

/// All of them, in the order in which they are listed.
std::span<const BenchScene> bench_scenes();

/// Throws Error with the nearest name.
const BenchScene& find_bench_scene(const std::string& name);

/// What hangs in the scene `cloth`: the sheet stands upright, and row 0 (vertices 0 to size - 1) is its upper
/// rim.
TriangleMesh hanging_grid(int size);

/// Stretches every cloth of a world in both directions about the middle of its upper row, which stays. Near
/// that row the stretch across begins at nothing, so that the rest shape solves all constraints. `strain`
/// 0.1: 10 %.
void stretch_cloths(World& world, double strain);

}  // namespace souple::app
