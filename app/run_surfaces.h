#pragma once

#include "app/surface_files.h"
#include "souple/world/world.h"

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

namespace souple::app {

/// Meshes of a run's fluids, written during the run: bit for bit the files that `souple surface` writes from
/// its folder afterwards.
class RunSurfaces {
 public:
  /// `method`: the value of the run's option; `run`: its folder; `done`: number of frames written earlier.
  /// Meshes all fluids, or all grains if there are no fluids. Writes no file. Throws Error if there is no
  /// object to mesh or a mesh of an earlier frame is missing.
  RunSurfaces(const std::string& method, const SceneDescription& scene, const World& world,
              const std::filesystem::path& run, std::uint64_t done);

  /// Creates the folder, for a new run.
  void start();
  /// Writes the meshes of the current world.
  void write(const World& world, std::uint64_t frame);
  /// Writes run.json for the frames so far; the run's own run.json must be up to date.
  void save() const;
  /// Removes files of an earlier, longer run, and saves. The run itself must be finished first.
  void finish();

  /// Folder, frames, triangles and time.
  std::string summary() const;

 private:
  SurfaceOrder order_;
  std::filesystem::path run_;
  double rate_;  // frames per second
  std::unique_ptr<Threads> threads_;
  std::vector<ObjectId> fluids_;
  ObjectFiles files_;  // per object
  std::uint64_t frames_, begun_;
};

}  // namespace souple::app
