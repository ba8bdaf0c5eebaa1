#pragma once

#include "render/subject.h"
#include "souple/io/playback.h"
#include "souple/scene/scene.h"

#include <filesystem>
#include <optional>
#include <vector>

namespace souple::app {

/// A run's folder as something to look at: objects from its caches; colliders, thicknesses and the camera
/// from the scene that run.json embeds (none of these for the run of a program, which embeds no scene).
class CacheSubject {
 public:
  /// `path` is the folder or its run.json. Throws Error when it cannot be read.
  explicit CacheSubject(const std::filesystem::path& path);

  const Playback& playback() const { return playback_; }
  std::uint64_t frames() const { return playback_.frames(); }
  /// Nothing when no scene is embedded.
  const std::optional<SceneDescription>& scene() const { return scene_; }

  /// The frame, in [1, frames()]. With `velocities` the frame before is read as well: caches hold positions
  /// only, so a velocity is the way of one frame over its time. Valid until the next call. Throws Error.
  const render::Subject& read(std::uint64_t frame, bool velocities = false);

 private:
  void describe_bodies();
  void find_velocities(std::uint64_t frame);

  Playback playback_;
  std::optional<SceneDescription> scene_;
  World stage_;                                 ///< holds the colliders, and nothing else
  std::vector<std::vector<Vec3f>> velocities_;  ///< by object [m/s]
  std::vector<std::size_t> shape_;              ///< how many vertices and triangles each object has
  render::Subject subject_;
};

}  // namespace souple::app
