#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

/// run.json, the manifest of an output folder: what was run, and which file holds what.
namespace souple {

/// Numbers by name, in order; a number that is not finite is null in the file.
using NamedNumbers = std::vector<std::pair<std::string, double>>;

/// What a step said of a frame.
struct FrameReport {
  std::uint64_t frame = 0;         ///< 1 is the first
  double time = 0;                 ///< seconds of simulated time
  NamedNumbers values;             ///< e.g. contacts, largest_strain, residual.distance
  std::vector<std::string> flags;  ///< what the step complained of
  NamedNumbers milliseconds;       ///< by stage; kept apart in the file, as `timings`
};

struct ManifestFile {
  std::string format;        ///< "obj", "pc2", "mdd", "ply"
  std::string path;          ///< relative to the folder; a sequence is named by its first frame's file
  std::uint64_t frames = 0;  ///< frames it holds; 0 for a mesh at rest
  bool operator==(const ManifestFile&) const = default;
};

struct ManifestObject {
  std::string name;
  std::string kind;  ///< "cloth", "soft_body", "rope", "grains", "obstacle", ...
  std::vector<ManifestFile> files;
  std::uint64_t points = 0;
  std::uint64_t triangles = 0;
  bool operator==(const ManifestObject&) const = default;
};

struct RunManifest {
  std::string version;       ///< of the library
  bool complete = false;     ///< false while the run goes on, and after one that was stopped
  std::string scene;         ///< JSON text of the scene; empty for a world built by a program
  std::string settings;      ///< JSON text of an object: what the run was told beside the scene; may be empty
  double frame_rate = 60;    ///< frames a second
  std::uint64_t frames = 0;  ///< captured
  std::vector<ManifestObject> objects;
  std::vector<std::string> notes;    ///< e.g. which object fell back to OBJ, and why
  std::vector<FrameReport> reports;  ///< at most one a frame, ascending
};

/// The text of a run.json. All that depends on the clock is on the line of `timings`, the last one, so that
/// two runs compare equal without it. Throws Error when `scene` or `settings` is not JSON.
std::string manifest_text(const RunManifest& manifest);
/// Throws Error that names the place in the file, e.g. "run.json: objects[2].files[0].path: ...".
RunManifest parse_manifest(std::string_view text, const std::string& name);

/// Writes FOLDER/run.json, whole or not at all.
void write_manifest(const std::filesystem::path& folder, const RunManifest& manifest);
/// `path` is the folder, or its run.json.
RunManifest read_manifest(const std::filesystem::path& path);

}  // namespace souple
