#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace souple::app {

/// Folders that are searched for shipped scenes, in order. These are the folders of the environment variable
/// SOUPLE_SCENES (separated by colons), ../share/souple/scenes relative to the program, and the source tree it was
/// built from. Each is listed once, whether it exists or not.
std::vector<std::filesystem::path> scene_folders();

struct ShippedScene {
  std::string name;  ///< file name without .json
  std::filesystem::path file;
};
/// All scenes of these folders by name; of two with the same name, the first found.
std::vector<ShippedScene> shipped_scenes();

/// `scene` is a file or the name of a shipped scene. Throws Error that suggests the nearest name.
std::filesystem::path find_scene(const std::string& scene);

}  // namespace souple::app
