#pragma once

#include "souple/scene/scene.h"

#include <filesystem>
#include <memory>

namespace souple::app {

/// `souple run --picture FILE.png`.
class LastPicture {
 public:
  /// Throws Error, before anything is simulated, when no picture can be made or written there.
  explicit LastPicture(const std::filesystem::path& file);
  ~LastPicture();
  LastPicture(const LastPicture&) = delete;
  LastPicture& operator=(const LastPicture&) = delete;

  /// The world as it is, seen by the scene's camera. Throws Error when it cannot be written.
  void write(const World& world, const SceneDescription& scene);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace souple::app
