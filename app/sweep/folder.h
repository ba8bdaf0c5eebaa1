#pragma once

#include "app/commands.h"
#include "app/sweep/plan.h"
#include "souple/files/output_lock.h"
#include "souple/io/recorder.h"
#include "souple/scene/scene.h"

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace souple::app {

/// A sweep and its folder: sweep.json, the table, and a folder for each run.
struct Sweep {
  SweepPlan plan;
  std::string name;            ///< of the scene
  std::filesystem::path file;  ///< of the scene
  std::filesystem::path out;
  std::vector<CacheFormat> formats;  ///< of the caches of each run; empty: none
  bool pictures = false;             ///< whether each run renders its last frame
  bool quiet = false;
  std::string manifest;  ///< text of sweep.json: version, scene, settings
  std::string id;        ///< hash of the manifest, in each result

  /// Throws Error for invalid input.
  explicit Sweep(const SweepRequest& request);

  std::filesystem::path folder_of(std::uint64_t run) const;  ///< out/0007
  SceneDescription scene_of(std::uint64_t run) const;
  /// Throws Error where a combination gives an invalid scene.
  void check_all() const;
};

/// Writes sweep.json, unless it is there. Throws Error where the folder belongs to another sweep.
void claim_folder(const Sweep& sweep);

/// The lock of a file that several processes write; waits a few seconds for it. Throws Error.
OutputLock wait_for_lock(const std::filesystem::path& file);

}  // namespace souple::app
