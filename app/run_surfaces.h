#pragma once

#include "app/surface_files.h"
#include "souple/world/world.h"

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

namespace souple::app {

/// Meshes of a run's fluids, made while it runs: the files that `souple surface` makes of its folder
/// afterwards, bit by bit.
class RunSurfaces {
 public:
  /// `method` as a run was told it, `run` its folder, `done` frames of it that were written before. Of all
  /// fluids; else of all grains. Writes nothing. Throws Error where there is nothing to mesh, or, with `done`
  /// above 0, where meshes of these frames are missing.
  RunSurfaces(const std::string& method, const SceneDescription& scene, const World& world,
              const std::filesystem::path& run, std::uint64_t done);

  /// Creates the folder, for a run that begins.
  void start();
  /// Of the world as it is.
  void write(const World& world, std::uint64_t frame);
  /// Writes run.json for the frames so far; that of the run has to be up to date.
  void save() const;
  /// Removes what a longer run left, and saves. As much of the run has to be finished.
  void finish();

  /// The folder, frames, triangles and what they took.
  std::string summary() const;

 private:
  SurfaceOrder order_;
  std::filesystem::path run_;
  double rate_;  // frames a second
  std::unique_ptr<Threads> threads_;
  std::vector<ObjectId> fluids_;
  ObjectFiles files_;  // of each
  std::uint64_t frames_, begun_;
};

}  // namespace souple::app
