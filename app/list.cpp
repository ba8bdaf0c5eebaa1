#include "app/commands.h"
#include "app/exit_codes.h"
#include "app/find_scene.h"
#include "souple/error.h"
#include "souple/scene/json.h"
#include "souple/scene/scene.h"

#include <algorithm>
#include <cstdio>

namespace souple::app {

namespace {

/// The scene's description; if the scene cannot be read, the reason.
std::string describe(const std::filesystem::path& file) {
  try {
    return load_scene(file).description;
  } catch (const Error& error) {
    return std::string("(broken) ") + error.what();
  }
}

void print_json(const std::vector<ShippedScene>& scenes) {
  using scene_format::Json;
  Json list = Json::array();
  for (const ShippedScene& scene : scenes) {
    Json entry = Json::object();
    entry.set("name", Json::of(scene.name));
    entry.set("file", Json::of(scene.file.string()));
    entry.set("description", Json::of(describe(scene.file)));
    list.items.push_back(std::move(entry));
  }
  std::fputs(scene_format::dump_json(list).c_str(), stdout);
}

}  // namespace

int list(bool as_json) {
  const std::vector<ShippedScene> scenes = shipped_scenes();
  if (as_json) {
    print_json(scenes);
    return success;
  }
  std::size_t widest = 0;
  for (const ShippedScene& scene : scenes) widest = std::max(widest, scene.name.size());
  for (const ShippedScene& scene : scenes) {
    std::printf("%-*s  %s\n", static_cast<int>(widest), scene.name.c_str(), describe(scene.file).c_str());
  }
  if (scenes.empty())
    std::fputs("no scenes found; `souple info` lists the folders that are searched\n", stdout);
  return success;
}

}  // namespace souple::app
