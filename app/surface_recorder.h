#pragma once

#include "app/surface_files.h"
#include "souple/io/manifest_writer.h"

#include <cstdint>
#include <filesystem>
#include <optional>

namespace souple::app {

/// The run.json of a folder of surfaces. It and the files of the surfaces hold the same frames, whenever the disk fills
/// up.
class SurfaceRecorder {
 public:
  /// `source` is the run.json of the run that the particles are of; its reports are not used.
  SurfaceRecorder(std::filesystem::path folder, RunManifest source);

  /// The surfaces of each object; add them before the first frame.
  ObjectFiles& objects() { return objects_; }
  const ObjectFiles& objects() const { return objects_; }
  /// Continues after frame `done`, with the reports of `before`. Throws Error on a full disk.
  void resume(const RunManifest& before, std::uint64_t done);
  /// Call it when all objects have written frame `frame`; `time` is that of its report [s]. Throws Error on a full
  /// disk.
  void add(std::uint64_t frame, const std::optional<double>& time);
  std::uint64_t frames() const { return frames_; }  ///< with surfaces of all objects
  /// Writes run.json for the frames so far; `complete` says whether the source ended as planned.
  void save(bool complete);
  /// Removes a frame that failed and files of a longer earlier run, and writes run.json.
  void finish(bool complete);

 private:
  RunManifest manifest(bool complete) const;

  RunManifest source_;
  ManifestWriter run_json_;
  ObjectFiles objects_;
  std::uint64_t frames_ = 0;
  std::size_t listed_ = 0;  // number of objects in the run.json whose space is reserved
};

}  // namespace souple::app
