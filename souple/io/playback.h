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

/// A finished or stopped run's folder, frame by frame: what a Recorder wrote.
class Playback {
 public:
  struct Object {
    std::string name, kind;           ///< as in run.json
    std::vector<Triangle> triangles;  ///< of the mesh at rest; empty for ropes and grains
    std::vector<Vec3d> rest;          ///< m; user order
    std::vector<Vec3f> positions,
        normals;  ///< of the frame that was read last; normals empty without triangles
  };

  /// `path` is the folder or its run.json. Throws Error when the manifest or a file it names is missing or
  /// damaged, naming it.
  explicit Playback(const std::filesystem::path& path);
  ~Playback();
  Playback(Playback&&) noexcept;
  Playback& operator=(Playback&&) noexcept;

  const RunManifest& manifest() const;
  std::uint64_t frames() const;            ///< that can be read; 0 is none
  double time(std::uint64_t frame) const;  ///< s; frame 1 is the first that was captured
  /// Reads the frame, in [1, frames()], into `objects`. Throws Error when a file cannot be read any more.
  void read(std::uint64_t frame);
  std::uint64_t frame() const;  ///< the one read last; 0 before the first
  std::span<const Object> objects() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace souple
