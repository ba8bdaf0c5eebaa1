#pragma once

#include "render/subject.h"
#include "souple/io/playback.h"
#include "souple/scene/scene.h"

#include <filesystem>
#include <optional>
#include <vector>

namespace souple::app {

/// A run's folder as a Subject: objects from its caches; colliders, thicknesses and the camera from the scene
/// embedded in run.json. Runs of programs embed no scene and have none of these.
class CacheSubject {
 public:
  /// `path` is the folder or its run.json. Throws Error if it cannot be read.
  explicit CacheSubject(const std::filesystem::path& path);

  const Playback& playback() const { return playback_; }
  std::uint64_t frames() const { return playback_.frames(); }
  /// Empty if no scene is embedded.
  const std::optional<SceneDescription>& scene() const { return scene_; }

  /// Reads a frame in [1, frames()]. With `velocities` it also reads the previous frame: caches hold only
  /// positions, so a velocity is the displacement over a frame divided by its time. Valid until the next
  /// call. Throws Error.
  const render::Subject& read(std::uint64_t frame, bool velocities = false);

 private:
  void describe_bodies();
  void find_velocities(std::uint64_t frame);

  Playback playback_;
  std::optional<SceneDescription> scene_;
  World stage_;                                 ///< contains only the colliders
  std::vector<std::vector<Vec3f>> velocities_;  ///< per object [m/s]
  std::vector<std::size_t> shape_;              ///< per object: numbers of vertices and triangles
  render::Subject subject_;
};

}  // namespace souple::app
