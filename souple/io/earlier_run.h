#pragma once

#include "souple/io/manifest.h"

#include <filesystem>
#include <optional>

namespace souple {

/// The last run into a folder. A new run removes the files that its manifest lists, which would be stale beside
/// the new ones, and nothing else. Without a readable manifest nothing is removed.
class EarlierRun {
 public:
  explicit EarlierRun(std::filesystem::path folder);

  /// Removes everything but complete PC2 and MDD files. Call before the new run writes a file.
  void remove();
  /// Removes the PC2 and MDD files that the new run will not replace when it ends. Call after it began its own.
  void remove_caches();

 private:
  std::filesystem::path folder_;
  std::optional<RunManifest> manifest_;
};

}  // namespace souple
