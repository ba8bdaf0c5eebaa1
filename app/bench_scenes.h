#pragma once

#include "souple/world/world.h"

#include <span>
#include <string>

// The scenes of `souple bench`: one row of a table each, built from a name and a size.

namespace souple::app {

struct BenchScene {
  const char* name;
  const char* description;  ///< one line
  const char* size_means;   ///< meaning of --size
  int default_size;
  int min_size, max_size;  ///< range of --size
  /// Fills an empty world.
  void (*build)(World& world, int size);
  bool counts_crossings = false;  ///< see World::count_crossings
  /// Changes the settings that options gave; nullptr: none.
  void (*prepare)(Settings& settings) = nullptr;
  double step = 1.0 / 60;  ///< s
};

/// All scenes, in listing order.
std::span<const BenchScene> bench_scenes();

/// Finds a scene by name. Throws Error that suggests the nearest name.
const BenchScene& find_bench_scene(const std::string& name);

/// The sheet of the scene `cloth`. It is vertical; row 0 (vertices 0 to size - 1) is its upper edge.
TriangleMesh hanging_grid(int size);

/// Stretches every cloth of a world in both directions about the middle of its upper row, which stays fixed.
/// Near that row the stretch across starts at zero, so that the rest shape satisfies all constraints.
/// `strain` 0.1 means 10 %.
void stretch_cloths(World& world, double strain);

}  // namespace souple::app
