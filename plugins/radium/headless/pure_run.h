#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

namespace souple::radium {

/// What a scene becomes without a renderer.
struct PureRun {
  std::uint64_t hash = 0;                               ///< of all positions and velocities, as World::hash
  std::map<std::string, std::vector<float>> positions;  ///< x, y, z of each vertex of each object [m]
};

/// Loads a scene file and steps its world, with nothing of the host layer and nothing of Radium. Throws
/// Error.
PureRun run_scene(const std::string& file, int frames, double dt);

/// From where a scene wants to be seen.
struct View {
  std::array<float, 3> from{}, to{};  ///< m
  float angle = 0;                    ///< vertical [degrees]
};
View view_of_scene(const std::string& file);

}  // namespace souple::radium
