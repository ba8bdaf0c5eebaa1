#pragma once

#include "souple/geometry/triangle_mesh.h"
#include "souple/io/manifest.h"

#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace souple {

/// A finished or stopped run's folder, frame by frame in any order: what a Recorder wrote. Only the frame
/// that was read last is in memory. Of a run that was killed, or still goes on, the frames that are whole
/// when it is opened. PC2 is preferred, then MDD, PLY, OBJ.
class Playback {
 public:
  struct Object {
    std::string name, kind;  ///< as in run.json; "foam" is what all fluids have made
    /// Of the mesh at rest, empty for ropes and grains. In frames where an object of the same name has
    /// another topology, those of that frame, and `rest` is its positions.
    std::vector<Triangle> triangles;
    std::vector<Vec3d> rest;  ///< m; user order. Without a rest mesh (sequences only): its first frame
    /// Of the frame that was read last. Empty where the object is not there; normals also without triangles.
    std::vector<Vec3f> positions, normals;
    /// Of particles whose files tell them, else empty. [m/s]
    std::vector<Vec3f> velocities;
  };

  /// `path` is the folder or its run.json. Throws Error when the manifest or a file it names is missing or
  /// damaged, naming it.
  explicit Playback(const std::filesystem::path& path);
  ~Playback();
  Playback(Playback&&) noexcept;
  Playback& operator=(Playback&&) noexcept;

  const RunManifest& manifest() const;
  std::uint64_t frames() const;            ///< that can be read; 0 is none
  double time(std::uint64_t frame) const;  ///< s; of the world when it was captured
  /// Reads the frame, in [1, frames()], into `objects`. Throws Error when a file cannot be read any more, or
  /// holds what is no number; no object has positions then, and frame() is 0.
  void read(std::uint64_t frame);
  std::uint64_t frame() const;  ///< the one read last; 0 before the first
  std::span<const Object> objects() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace souple
