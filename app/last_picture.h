#pragma once

#include "souple/scene/scene.h"

#include <filesystem>
#include <memory>
#include <string>

namespace souple::app {

struct PictureLook {
  int width = 1280, height = 720;  ///< pixels
  std::string label;               ///< in the lower left corner
};

/// `souple run --picture FILE.png`, and the pictures of a sweep.
class LastPicture {
 public:
  /// Throws Error, before any simulation, when no picture can be made or written to this file.
  explicit LastPicture(const std::filesystem::path& file, const PictureLook& look = {});
  ~LastPicture();
  LastPicture(const LastPicture&) = delete;
  LastPicture& operator=(const LastPicture&) = delete;

  /// Renders the world's current state with the scene's camera. Throws Error when the file cannot be written.
  void write(const World& world, const SceneDescription& scene);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace souple::app
