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

/// Reads the output folder of a Recorder, frame by frame in any order. Only the last frame read is in memory.
/// For a killed or running simulation it offers the frames that are complete when it opens the folder. It
/// prefers PC2, then MDD, PLY, OBJ.
class Playback {
 public:
  struct Object {
    std::string name, kind;  ///< as in run.json; "foam": the foam of all fluids
    /// Triangles of the rest mesh; empty for ropes and grains. In frames where an object of this name has
    /// another topology: triangles of that frame, and `rest` holds its positions.
    std::vector<Triangle> triangles;
    std::vector<Vec3d> rest;  ///< m; user order. Without a rest mesh (sequences only): the first frame
    /// Vertices of the last frame read. Empty if the object is absent; normals also without triangles.
    std::vector<Vec3f> positions, normals;
    /// Velocities of particles if their files hold them, else empty. [m/s]
    std::vector<Vec3f> velocities;
    std::vector<std::uint8_t>
        foam_kinds;  ///< FoamKind of each particle of foam if their files hold them, else empty
  };

  /// `path` is the folder or its run.json. Throws Error if the manifest or one of its files is missing or
  /// damaged; the message names the file.
  explicit Playback(const std::filesystem::path& path);
  ~Playback();
  Playback(Playback&&) noexcept;
  Playback& operator=(Playback&&) noexcept;

  const RunManifest& manifest() const;
  std::uint64_t frames() const;            ///< number of readable frames
  double time(std::uint64_t frame) const;  ///< time of the world at the capture [s]
  /// Reads the frame, in [1, frames()], into `objects`. Throws Error if a file can no longer be read or holds numbers
  /// that are not finite. Then no object has positions, and frame() is 0.
  void read(std::uint64_t frame);
  std::uint64_t frame() const;  ///< the last frame read; 0 before the first
  std::span<const Object> objects() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace souple
