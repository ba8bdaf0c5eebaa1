#pragma once

#include "render/subject.h"
#include "souple/io/playback.h"
#include "souple/scene/scene.h"

#include <filesystem>
#include <optional>
#include <vector>

namespace souple::app {

/// A run's folder as a subject to draw. Objects come from the caches; colliders, thicknesses and the camera
/// come from the scene that run.json embeds. The run of a program embeds no scene, so these are missing.
class CacheSubject {
 public:
  /// `path` is the folder or its run.json. Throws Error when it cannot be read.
  explicit CacheSubject(const std::filesystem::path& path);

  const Playback& playback() const { return playback_; }
  std::uint64_t frames() const { return playback_.frames(); }
  /// Empty when run.json embeds no scene.
  const std::optional<SceneDescription>& scene() const { return scene_; }

  /// Reads a frame in [1, frames()]. Caches hold positions only. With `velocities` the frame before is read as well,
  /// and a velocity is the displacement over one frame divided by its duration. Valid until the next call. Throws
  /// Error.
  const render::Subject& read(std::uint64_t frame, bool velocities = false);

 private:
  void describe_bodies();
  void find_velocities(std::uint64_t frame);

  Playback playback_;
  std::optional<SceneDescription> scene_;
  World collider_world_;                        ///< holds only the colliders
  std::vector<std::vector<Vec3f>> velocities_;  ///< per object [m/s]
  std::vector<std::size_t> shape_;              ///< per object: numbers of vertices and triangles
  render::Subject subject_;
};

}  // namespace souple::app
