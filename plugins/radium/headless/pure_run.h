#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

namespace souple::radium {

/// Result of simulating a scene without a renderer.
struct PureRun {
  std::uint64_t hash = 0;  ///< hash of all positions and velocities, as World::hash
  std::map<std::string, std::vector<float>> positions;  ///< x, y, z of each vertex of each object [m]
};

/// Loads a scene file and steps its world without the host layer and without Radium. Throws
/// Error.
PureRun run_scene(const std::string& file, int frames, double dt);

/// The camera of a scene.
struct View {
  std::array<float, 3> from{}, to{};  ///< m
  float angle = 0;                    ///< vertical [degrees]
};
View view_of_scene(const std::string& file);

}  // namespace souple::radium
