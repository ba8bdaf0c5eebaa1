#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace souple::app {

/// Folders of shipped scenes, in search order: those of the environment variable SOUPLE_SCENES (separated by
/// colons), ../share/souple/scenes relative to the program, the program's source tree. Each folder once,
/// existing or not.
std::vector<std::filesystem::path> scene_folders();

struct ShippedScene {
  std::string name;  ///< the file without .json
  std::filesystem::path file;
};
/// All scenes of these folders by name; of scenes with equal names, the first.
std::vector<ShippedScene> shipped_scenes();

/// The file of `scene`: a file, or the name of a shipped scene. Throws Error with the nearest name.
std::filesystem::path find_scene(const std::string& scene);

}  // namespace souple::app
