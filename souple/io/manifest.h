#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

/// run.json, the manifest of an output folder: the simulated scene, and the content of each file.
namespace souple {

/// Named numbers, in order; the file stores null for a number that is not finite.
using NamedNumbers = std::vector<std::pair<std::string, double>>;

/// The step report of a frame.
struct FrameReport {
  std::uint64_t frame = 0;         ///< 1 is the first
  double time = 0;                 ///< seconds of simulated time
  NamedNumbers values;             ///< e.g. contacts, largest_strain, residual.distance
  std::vector<std::string> flags;  ///< the step's warnings
  NamedNumbers milliseconds;       ///< per stage; in the file separate, as `timings`
};

struct ManifestFile {
  std::string format;        ///< "obj", "pc2", "mdd", "ply"
  std::string path;          ///< relative to the folder; of a sequence: the file of its first frame
  std::uint64_t frames = 0;  ///< number of frames; 0: rest mesh
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
  std::string version;       ///< version of the library
  bool complete = false;     ///< false during a run and after a stopped run
  std::string scene;         ///< JSON text of the scene; empty for a world built by a program
  std::string settings;      ///< JSON object: options of the run beside the scene; may be empty
  double frame_rate = 60;    ///< frames per second
  std::uint64_t frames = 0;  ///< captured
  std::vector<ManifestObject> objects;
  std::vector<std::string> notes;    ///< e.g. which object fell back to OBJ, and why
  std::vector<FrameReport> reports;  ///< at most one per frame, ascending
};

/// A frame's lines in run.json: in `reports` and in `timings`; without times the second is empty.
struct ReportText {
  std::string report, timing;
};
/// Throws Error if a name is not UTF-8.
ReportText report_text(const FrameReport& report);

/// Calls its argument with the texts of each report, in order.
using ReportTexts = std::function<void(const std::function<void(std::string_view, std::string_view)>&)>;

/// A JSON text in one line; "null" for an empty one. Throws Error that names `what`, such as scene_name, if it is none.
std::string compact_json(const std::string& text, const char* what);
inline constexpr const char* scene_name = "the scene of a run";
inline constexpr const char* settings_name = "the settings of a run";
/// The text of a run.json up to its reports, with these texts of compact_json for the scene and the settings.
std::string manifest_head(const RunManifest& manifest, const std::string& scene, const std::string& settings);
/// The rest of a run.json: passes it to `write` piece by piece, and calls `reports` twice.
void write_reports(const ReportTexts& reports, const std::function<void(std::string_view)>& write);

/// The text of a run.json. All wall-clock times are on the last line, `timings`, so that two runs compare
/// equal without that line. Throws Error if `scene` or `settings` is not JSON.
std::string manifest_text(const RunManifest& manifest);
/// Throws Error with the JSON path, e.g. "run.json: objects[2].files[0].path: ...".
RunManifest parse_manifest(std::string_view text, const std::string& name);

/// Writes FOLDER/run.json, completely or not at all.
void write_manifest(const std::filesystem::path& folder, const RunManifest& manifest);
/// `path` is the folder, or its run.json.
RunManifest read_manifest(const std::filesystem::path& path);
/// Reads all but the reports, in the memory of the file's text.
RunManifest read_manifest_without_reports(const std::filesystem::path& path);

}  // namespace souple
