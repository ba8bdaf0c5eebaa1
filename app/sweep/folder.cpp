#include "app/sweep/folder.h"

#include "app/find_scene.h"
#include "souple/error.h"
#include "souple/files/atomic_file.h"
#include "souple/files/file.h"
#include "souple/files/output_lock.h"
#include "souple/math/fnv1a.h"
#include "souple/scene/json.h"
#include "souple/scene/run_record.h"
#include "souple/version.h"

#include <algorithm>
#include <chrono>
#include <optional>
#include <system_error>
#include <thread>

#include <fmt/core.h>

namespace souple::app {

namespace fs = std::filesystem;
using scene_format::Json;

namespace {

constexpr const char* manifest_name = "sweep.json";

std::vector<std::string> arguments_of(const SweepRequest& request) {
  std::vector<std::string> arguments = request.settings;
  if (request.frames) arguments.push_back(fmt::format("frames={}", *request.frames));
  return arguments;
}

std::vector<CacheFormat> formats_of(const std::vector<std::string>& names) {
  std::vector<CacheFormat> formats;
  for (const auto& [known, format] : cache_formats())
    if (std::find(names.begin(), names.end(), known) != names.end()) formats.push_back(format);
  return formats;
}

/// Whatever determines results: another version, scene or setting gives another text.
std::string manifest_of(const Sweep& sweep) {
  Json settings = Json::object();
  for (const SweepSetting& setting : sweep.plan.settings()) {
    Json values = Json::array();
    for (const std::string& value : setting.values) values.items.push_back(Json::of(value));
    settings.set(setting.path, std::move(values));
  }
  Json formats = Json::array();
  for (const auto& [name, format] : cache_formats()) {
    if (std::find(sweep.formats.begin(), sweep.formats.end(), format) != sweep.formats.end())
      formats.items.push_back(Json::of(name));
  }
  Json manifest = Json::object();
  manifest.set("version", Json::of(version));
  manifest.set("name", Json::of(sweep.name));
  manifest.set("runs", Json::whole(static_cast<std::int64_t>(sweep.plan.runs())));
  manifest.set("settings", std::move(settings));
  manifest.set("write", std::move(formats));
  manifest.set("first_scene", scene_format::parse_json(to_json(sweep.scene_of(1)), sweep.file.string()));
  return scene_format::dump_json(manifest);
}

/// "other settings", for the manifest that is there.
std::string difference(const std::string& there, const std::string& wanted, const fs::path& file) {
  constexpr std::pair<const char*, const char*> parts[] = {
      {"version", "another version of souple"},
      {"name", "another scene"},
      {"settings", "other settings"},
      {"write", "other caches (--write)"},
      {"first_scene", "a scene file that has changed since"}};
  const Json a = scene_format::parse_json(there, file.string()), b = scene_format::parse_json(wanted, "");
  for (const auto& [key, words] : parts) {
    const Json* const of_a = a.find(key);
    if (of_a == nullptr || !(*of_a == *b.find(key))) return words;
  }
  return "another layout of this file";
}

std::optional<std::string> manifest_in(const fs::path& file) {
  std::error_code error;
  if (!fs::exists(file, error)) return std::nullopt;
  return read_whole_file(file);
}

}  // namespace

Sweep::Sweep(const SweepRequest& request)
    : plan(arguments_of(request)),
      file(find_scene(request.scene)),
      formats(formats_of(request.formats)),
      pictures(request.sheet),
      quiet(request.quiet) {
  name = file.stem().string();
  out = request.out.empty() ? fs::path("out") / (name + "_sweep") : request.out;
  manifest = manifest_of(*this);
  id = fmt::format("{:016x}", fnv1a64(manifest));
}

fs::path Sweep::folder_of(std::uint64_t run) const {
  return out / fmt::format("{:04}", run);
}

SceneDescription Sweep::scene_of(std::uint64_t run) const {
  return load_scene(file, plan.settings_of(run));
}

void Sweep::check_all() const {
  for (std::uint64_t run = 1; run <= plan.runs(); ++run) {
    try {
      scene_of(run);
    } catch (const Error& error) {
      throw Error(fmt::format("run {} ({}): {}", run, plan.label_of(run), error.what()));
    }
  }
}

void claim_folder(const Sweep& sweep) {
  const fs::path file = sweep.out / manifest_name;
  create_folder(sweep.out);
  std::optional<std::string> there = manifest_in(file);
  if (!there) {
    const OutputLock lock = wait_for_lock(file);
    there = manifest_in(file);  // written meanwhile?
    if (!there) {
      write_file_atomically(file, sweep.manifest, Sync::yes);
      return;
    }
  }
  if (*there == sweep.manifest) return;
  throw Error(fmt::format(
      "{}: the folder holds a sweep with {}; choose another --out, repeat its command, or delete the folder",
      sweep.out.string(), difference(*there, sweep.manifest, file)));
}

OutputLock wait_for_lock(const fs::path& file) {
  constexpr auto pause = std::chrono::milliseconds(20);
  constexpr int tries = 500;
  for (int i = 1; i < tries; ++i) {
    try {
      return OutputLock::of_file(file);
    } catch (const Error&) {
      std::this_thread::sleep_for(pause);
    }
  }
  return OutputLock::of_file(file);
}

}  // namespace souple::app
