#include "app/find_scene.h"

#include "souple/error.h"
#include "souple/scene/nearest.h"

#include <algorithm>
#include <cstdlib>

namespace souple::app {

namespace fs = std::filesystem;

namespace {

void add_once(const fs::path& folder, std::vector<fs::path>& folders) {
  std::error_code error;
  for (const fs::path& known : folders) {
    if (known == folder || fs::equivalent(known, folder, error)) return;
  }
  folders.push_back(folder);
}

void add_listed(const std::string& list, std::vector<fs::path>& folders) {
  for (std::size_t begin = 0; begin <= list.size();) {
    const std::size_t end = std::min(list.find(':', begin), list.size());
    if (end > begin) add_once(list.substr(begin, end - begin), folders);
    begin = end + 1;
  }
}

bool is_readable_file(const fs::path& path) {
  std::error_code error;
  return fs::exists(path, error) && !fs::is_directory(path, error);
}

}  // namespace

std::vector<fs::path> scene_folders() {
  std::vector<fs::path> folders;
  if (const char* listed = std::getenv("SOUPLE_SCENES")) add_listed(listed, folders);
  std::error_code error;
  const fs::path program = fs::read_symlink("/proc/self/exe", error);
  if (!error)
    add_once((program.parent_path().parent_path() / "share/souple/scenes").lexically_normal(), folders);
  add_once(SOUPLE_SOURCE_SCENES, folders);
  return folders;
}

std::vector<ShippedScene> shipped_scenes() {
  std::vector<ShippedScene> scenes;
  for (const fs::path& folder : scene_folders()) {
    std::error_code error;
    for (const fs::directory_entry& entry : fs::directory_iterator(folder, error)) {
      const fs::path& file = entry.path();
      const std::string name = file.stem().string();
      const bool known = std::any_of(scenes.begin(), scenes.end(),
                                     [&](const ShippedScene& scene) { return scene.name == name; });
      if (file.extension() == ".json" && is_readable_file(file) && !known) scenes.push_back({name, file});
    }
  }
  std::sort(scenes.begin(), scenes.end(),
            [](const ShippedScene& a, const ShippedScene& b) { return a.name < b.name; });
  return scenes;
}

fs::path find_scene(const std::string& scene) {
  if (is_readable_file(scene)) return scene;
  std::vector<std::string> names;
  for (const ShippedScene& shipped : shipped_scenes()) {
    if (shipped.name == scene) return shipped.file;
    names.push_back(shipped.name);
  }
  const bool looks_like_file = scene.find('/') != std::string::npos || fs::path(scene).extension() == ".json";
  if (looks_like_file) throw Error(scene + ": no such file");
  throw Error(scene + ": no such file, and no scene of that name" + scene_format::suggestion(scene, names) +
              " (`souple list` lists all scenes)");
}

}  // namespace souple::app
