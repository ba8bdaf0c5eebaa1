#include "souple/io/earlier_run.h"

#include "souple/error.h"
#include "souple/files/atomic_file.h"
#include "souple/io/manifest.h"
#include "souple/io/sequence.h"

#include <system_error>
#include <utility>

namespace souple {

namespace fs = std::filesystem;

namespace {

std::optional<RunManifest> manifest_in(const fs::path& folder) {
  std::error_code ignored;
  if (!fs::is_regular_file(folder / "run.json", ignored)) return std::nullopt;
  try {
    return read_manifest_without_reports(folder);
  } catch (const Error&) {  // damaged, or of another version
    return std::nullopt;
  }
}

void remove_file(const fs::path& path) {
  std::error_code ignored;
  if (!fs::is_directory(path, ignored)) fs::remove(path, ignored);
}

bool is_cache(const ManifestFile& file) {
  return file.format == "pc2" || file.format == "mdd";
}

}  // namespace

EarlierRun::EarlierRun(fs::path folder) : folder_(std::move(folder)), manifest_(manifest_in(folder_)) {}

void EarlierRun::remove() {
  if (!manifest_) return;
  for (const ManifestObject& object : manifest_->objects) {
    for (const ManifestFile& file : object.files) {
      const fs::path path = folder_ / file.path;
      if (is_cache(file))
        remove_file(part_path(path));  // of a killed run
      else if (file.frames > 0)
        remove_sequence(path, file.frames, manifest_->frames);
      else
        remove_file(path);
    }
  }
  remove_file(folder_ / "run.json");
}

void EarlierRun::remove_caches() {
  if (!manifest_) return;
  for (const ManifestObject& object : manifest_->objects) {
    for (const ManifestFile& file : object.files) {
      const fs::path path = folder_ / file.path;
      std::error_code ignored;
      if (is_cache(file) && !fs::exists(part_path(path), ignored)) remove_file(path);
    }
  }
}

}  // namespace souple
