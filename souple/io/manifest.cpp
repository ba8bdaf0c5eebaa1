#include "souple/io/manifest.h"

#include "souple/error.h"
#include "souple/files/atomic_file.h"
#include "souple/files/relative_path.h"

#include <cmath>
#include <initializer_list>
#include <limits>
#include <map>
#include <utility>

#include <fmt/core.h>
#include <nlohmann/json.hpp>

namespace souple {

namespace {

using Json = nlohmann::ordered_json;

constexpr int largest_depth = 64;

/// Removes the prefix "[json.exception.parse_error.101] " of nlohmann.
std::string reason(const nlohmann::json::exception& error) {
  const std::string text = error.what();
  const auto end = text.find("] ");
  return end == std::string::npos ? text : text.substr(end + 2);
}

/// Throws Error for invalid JSON, and for nesting that would exhaust the stack of recursive readers.
/// Leaves the members of the outermost object out whose keys `omits` returns true for.
Json parse_json(std::string_view text, const std::string& name, bool (*omits)(const Json& key) = nullptr) {
  const auto limit_depth = [&](int depth, Json::parse_event_t event, Json& parsed) {
    if (depth > largest_depth)
      throw Error(fmt::format("{}: is nested deeper than {} levels", name, largest_depth));
    return !(omits && depth == 1 && event == Json::parse_event_t::key && omits(parsed));
  };
  try {
    return Json::parse(text.begin(), text.end(), limit_depth);
  } catch (const nlohmann::json::exception& error) {
    throw Error(name + ": is not JSON: " + reason(error));
  }
}

// Writing.

// Arrays and objects of the library allocate memory in their destructors, and end a process that has none. A run that
// records is to outlive that, so only texts and numbers, which do not, are made with it.

/// In quotation marks. Throws the library's exception if it is not UTF-8.
std::string quoted(const std::string& text) {
  return Json(text).dump();
}

/// The shortest text that reads back to the same number; null if it is not finite.
std::string number_text(double number) {
  return Json(number).dump();
}

/// The texts of all items with `between` from one to the next.
template <class Items, class Text>
std::string joined(const Items& items, const char* between, const Text& text_of) {
  std::string text;
  bool first = true;
  for (const auto& item : items) {
    if (!std::exchange(first, false)) text += between;
    text += text_of(item);
  }
  return text;
}

std::string text_of(const NamedNumbers& numbers) {
  return "{" +
         joined(numbers, ",", [](const auto& n) { return quoted(n.first) + ":" + number_text(n.second); }) +
         "}";
}

std::string text_of(const ManifestFile& file) {
  return fmt::format(R"({{"format":{},"path":{},"frames":{}}})", quoted(file.format), quoted(file.path),
                     file.frames);
}

std::string text_of(const ManifestObject& object) {
  const std::string files = joined(object.files, ",", [](const ManifestFile& file) { return text_of(file); });
  return fmt::format(R"({{"name":{},"kind":{},"files":[{}],"topology":{{"points":{},"triangles":{}}}}})",
                     quoted(object.name), quoted(object.kind), files, object.points, object.triangles);
}

/// Result of `make`. Throws Error for values that JSON cannot hold, for example a name that is not UTF-8.
template <class Make>
auto as_text(const Make& make) {
  try {
    return make();
  } catch (const nlohmann::json::exception& error) {
    throw Error("run.json cannot be written: " + reason(error));
  }
}

/// [, one object per line, ]: readable with less and diff.
std::string lines_of(const std::vector<ManifestObject>& objects) {
  if (objects.empty()) return "[]";
  return "[\n  " + joined(objects, ",\n  ", [](const ManifestObject& object) { return text_of(object); }) +
         "\n]";
}

// Reading.

/// A value and its JSON path, for error messages.
struct Place {
  const Json& value;
  std::string path;

  [[noreturn]] void fail(const std::string& what) const { throw Error(path + ": " + what); }
};

Place item(const Place& array, std::size_t index) {
  return {array.value[index], fmt::format("{}[{}]", array.path, index)};
}

/// The value of a required key.
Place member(const Place& object, const std::string& key) {
  const auto found = object.value.find(key);
  if (found == object.value.end()) object.fail("has no \"" + key + "\"");
  return {*found, object.path + "." + key};
}

void require_object(const Place& place) {
  if (!place.value.is_object())
    place.fail(std::string("expected an object, found ") + place.value.type_name());
}

/// Checks that an object has only these keys.
void require_keys(const Place& place, std::initializer_list<std::string_view> keys) {
  require_object(place);
  for (const auto& [key, value] : place.value.items()) {
    bool known = false;
    for (const std::string_view k : keys) known = known || k == key;
    if (!known) place.fail("has a key \"" + key + "\", which is not known");
  }
}

std::string text(const Place& place) {
  if (!place.value.is_string()) place.fail(std::string("expected a text, found ") + place.value.type_name());
  return place.value.get<std::string>();
}

std::uint64_t count(const Place& place) {
  if (!place.value.is_number_unsigned())
    place.fail("expected a whole number from 0 up, found " +
               (place.value.is_number() ? place.value.dump() : std::string(place.value.type_name())));
  return place.value.get<std::uint64_t>();
}

double finite_number(const Place& place) {
  if (!place.value.is_number())
    place.fail(std::string("expected a number, found ") + place.value.type_name());
  const double number = place.value.get<double>();
  if (!std::isfinite(number)) place.fail("expected a finite number");
  return number;
}

bool truth(const Place& place) {
  if (!place.value.is_boolean())
    place.fail(std::string("expected true or false, found ") + place.value.type_name());
  return place.value.get<bool>();
}

template <class Read>
auto list(const Place& place, Read read) {
  if (!place.value.is_array()) place.fail(std::string("expected an array, found ") + place.value.type_name());
  std::vector<decltype(read(place))> items;
  items.reserve(place.value.size());
  for (std::size_t i = 0; i < place.value.size(); ++i) items.push_back(read(item(place, i)));
  return items;
}

NamedNumbers named_numbers(const Place& place) {
  require_object(place);
  NamedNumbers numbers;
  for (const auto& [key, value] : place.value.items()) {
    const Place number{value, place.path + "." + key};
    // JSON has no NaN; null represents numbers that are not finite.
    numbers.emplace_back(key,
                         value.is_null() ? std::numeric_limits<double>::quiet_NaN() : finite_number(number));
  }
  return numbers;
}

std::string embedded_text(const Place& place) {
  return place.value.is_null() ? std::string() : place.value.dump();
}

ManifestFile read_file(const Place& place) {
  require_keys(place, {"format", "path", "frames"});
  ManifestFile file{text(member(place, "format")), text(member(place, "path")),
                    count(member(place, "frames"))};
  if (!stays_inside_folder(file.path))
    member(place, "path").fail("\"" + file.path + "\" leads out of the folder; expected a relative path");
  return file;
}

ManifestObject read_object(const Place& place) {
  require_keys(place, {"name", "kind", "files", "topology"});
  const Place topology = member(place, "topology");
  require_keys(topology, {"points", "triangles"});
  ManifestObject object;
  object.name = text(member(place, "name"));
  object.kind = text(member(place, "kind"));
  object.files = list(member(place, "files"), read_file);
  object.points = count(member(topology, "points"));
  object.triangles = count(member(topology, "triangles"));
  return object;
}

FrameReport read_report(const Place& place) {
  require_keys(place, {"frame", "time", "values", "flags"});
  FrameReport report;
  report.frame = count(member(place, "frame"));
  report.time = finite_number(member(place, "time"));
  report.values = named_numbers(member(place, "values"));
  report.flags = list(member(place, "flags"), text);
  return report;
}

void check_reports(const Place& place, const std::vector<FrameReport>& reports, std::uint64_t frames) {
  for (std::size_t i = 0; i < reports.size(); ++i) {
    const Place frame = member(item(place, i), "frame");
    if (reports[i].frame < 1 || reports[i].frame > frames)
      frame.fail(fmt::format("{} is not one of the {} frames", reports[i].frame, frames));
    if (i > 0 && reports[i].frame <= reports[i - 1].frame) frame.fail("is not later than the one before");
  }
}

void read_timings(const Place& place, std::vector<FrameReport>& reports) {
  std::map<std::uint64_t, FrameReport*> by_frame;
  for (FrameReport& report : reports) by_frame[report.frame] = &report;
  list(place, [&by_frame](const Place& line) {
    require_keys(line, {"frame", "milliseconds"});
    const auto found = by_frame.find(count(member(line, "frame")));
    if (found == by_frame.end()) member(line, "frame").fail("has no report");
    found->second->milliseconds = named_numbers(member(line, "milliseconds"));
    return true;
  });
}

void check_format(const Place& root) {
  require_object(root);
  if (root.value.find("souple_run") == root.value.end())
    root.fail("is not the manifest of a run: it has no \"souple_run\"");
  const std::uint64_t format = count(member(root, "souple_run"));
  if (format == 1) return;
  const auto version = root.value.find("version");
  const std::string writer =
      version != root.value.end() && version->is_string() ? version->get<std::string>() : "?";
  root.fail(
      fmt::format("was written by Souple {} in format {}; this version reads format 1", writer, format));
}

std::filesystem::path manifest_file(const std::filesystem::path& path) {
  std::error_code ignored;
  return std::filesystem::is_directory(path, ignored) ? path / "run.json" : path;
}

RunManifest read_root(const Place& root) {
  check_format(root);
  require_keys(root, {"souple_run", "version", "complete", "frame_rate", "frames", "scene", "settings",
                      "objects", "notes", "reports", "timings"});
  RunManifest manifest;
  manifest.version = text(member(root, "version"));
  manifest.complete = truth(member(root, "complete"));
  manifest.frame_rate = finite_number(member(root, "frame_rate"));
  if (!(manifest.frame_rate > 0)) member(root, "frame_rate").fail("expected a number > 0");
  manifest.frames = count(member(root, "frames"));
  manifest.scene = embedded_text(member(root, "scene"));
  manifest.settings = embedded_text(member(root, "settings"));
  manifest.objects = list(member(root, "objects"), read_object);
  manifest.notes = list(member(root, "notes"), text);
  manifest.reports = list(member(root, "reports"), read_report);
  check_reports(member(root, "reports"), manifest.reports, manifest.frames);
  read_timings(member(root, "timings"), manifest.reports);
  return manifest;
}

}  // namespace

ReportText report_text(const FrameReport& report) {
  return as_text([&] {
    ReportText text;
    text.report =
        fmt::format(R"({{"frame":{},"time":{},"values":{},"flags":[{}]}})", report.frame,
                    number_text(report.time), text_of(report.values), joined(report.flags, ",", quoted));
    if (!report.milliseconds.empty())
      text.timing =
          fmt::format(R"({{"frame":{},"milliseconds":{}}})", report.frame, text_of(report.milliseconds));
    return text;
  });
}

std::string compact_json(const std::string& text, const char* what) {
  return text.empty() ? "null" : as_text([&] { return parse_json(text, what).dump(); });
}

std::string manifest_head(const RunManifest& manifest, const std::string& scene,
                          const std::string& settings) {
  return as_text([&] {
    return fmt::format(
        "{{\n\"souple_run\": 1,\n\"version\": {},\n\"complete\": {},\n"
        "\"frame_rate\": {},\n\"frames\": {},\n\"scene\": {},\n\"settings\": {},\n"
        "\"objects\": {},\n\"notes\": [{}],\n",
        quoted(manifest.version), manifest.complete ? "true" : "false", number_text(manifest.frame_rate),
        manifest.frames, scene, settings, lines_of(manifest.objects), joined(manifest.notes, ",", quoted));
  });
}

void write_reports(const ReportTexts& reports, const std::function<void(std::string_view)>& write) {
  write("\"reports\": [");
  bool any = false, any_timing = false;
  reports([&](std::string_view report, std::string_view) {
    write(std::exchange(any, true) ? ",\n  " : "\n  ");
    write(report);
  });
  write(any ? "\n],\n\"timings\": [" : "],\n\"timings\": [");
  reports([&](std::string_view, std::string_view timing) {
    if (timing.empty()) return;
    if (std::exchange(any_timing, true)) write(",");
    write(timing);
  });
  write("]\n}\n");
}

std::string manifest_text(const RunManifest& manifest) {
  std::vector<ReportText> texts;
  texts.reserve(manifest.reports.size());
  for (const FrameReport& report : manifest.reports) texts.push_back(report_text(report));
  std::string text = manifest_head(manifest, compact_json(manifest.scene, scene_name),
                                   compact_json(manifest.settings, settings_name));
  write_reports(
      [&](const auto& each) {
        for (const ReportText& lines : texts) each(lines.report, lines.timing);
      },
      [&](std::string_view piece) { text += piece; });
  return text;
}

RunManifest parse_manifest(std::string_view text, const std::string& name) {
  return read_root({parse_json(text, name), name});
}

void write_manifest(const std::filesystem::path& folder, const RunManifest& manifest) {
  write_file_atomically(folder / "run.json", manifest_text(manifest));
}

RunManifest read_manifest(const std::filesystem::path& path) {
  const auto file = manifest_file(path);
  return parse_manifest(read_whole_file(file), file.string());
}

RunManifest read_manifest_without_reports(const std::filesystem::path& path) {
  const auto file = manifest_file(path);
  Json root = parse_json(read_whole_file(file), file.string(),
                         [](const Json& key) { return key == "reports" || key == "timings"; });
  if (root.is_object()) root["reports"] = root["timings"] = Json::array();
  return read_root({root, file.string()});
}

}  // namespace souple
