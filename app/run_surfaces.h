#pragma once

#include "app/surface_recorder.h"
#include "souple/world/world.h"

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

namespace souple::app {

/// Meshes of a run's fluids, written during the run: bitwise the files that `souple surface` would write from
/// the run's folder afterwards.
class RunSurfaces {
 public:
  /// `method` is the argument of --surface, `run` the run's folder, `done` the number of frames written
  /// before. Meshes all fluids, or all grains if there is no fluid. Writes nothing. Throws Error where there
  /// is no object to mesh, or, with `done` above 0, where meshes of these frames are missing.
  RunSurfaces(const std::string& method, const SceneDescription& scene, const World& world,
              const std::filesystem::path& run, std::uint64_t done);

  /// Creates the folder for a new run, or continues its run.json.
  void start();
  /// Meshes the world's current state.
  void write(const World& world, std::uint64_t frame);
  /// Writes run.json for the frames so far.
  void save() { recorder_.save(false); }
  /// Removes files of a longer earlier run and saves run.json.
  void finish() { recorder_.finish(true); }

  /// Folder, frames, triangles and time.
  std::string summary() const;

 private:
  SurfaceFileOptions file_options_;
  double rate_;  // frames per second
  std::unique_ptr<Threads> threads_;
  std::vector<ObjectId> fluids_;
  SurfaceRecorder recorder_;  // its objects are those of `fluids_`
  RunManifest before_;        // of the run that is resumed
  std::uint64_t done_before_;
};

}  // namespace souple::app
