#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace souple::app {

/// Where shipped scenes are looked for, first to last: the folders of the environment variable SOUPLE_SCENES
/// (separated by colons), ../share/souple/scenes from the program, the source tree it was built from. Each
/// once, existing or not.
std::vector<std::filesystem::path> scene_folders();

struct ShippedScene {
  std::string name;  ///< the file without .json
  std::filesystem::path file;
};
/// All scenes of these folders by name; of two with one name the first found.
std::vector<ShippedScene> shipped_scenes();

/// `scene` is a file, or the name of a shipped scene. Throws Error with the nearest name.
std::filesystem::path find_scene(const std::string& scene);

}  // namespace souple::app
