#include "app/view/scene_list.h"

#include "app/view/recording.h"
#include "app/view/simulation.h"
#include "souple/error.h"
#include "souple/io/export_frames.h"

namespace souple::viewer {

namespace fs = std::filesystem;

namespace {

bool is_run(const fs::path& path) {
  std::error_code error;
  return fs::is_directory(path, error) || path.filename() == "run.json";
}

}  // namespace

std::unique_ptr<Session> SceneList::open(const fs::path& path) {
  std::error_code error;
  for (std::size_t i = 0; i < entries_.size(); ++i) {
    if (entries_[i].file == path || fs::equivalent(entries_[i].file, path, error)) return open(i);
  }
  entries_.push_back({is_run(path) ? run_name(path) : path.stem().string(), path});
  return open(entries_.size() - 1);
}

std::unique_ptr<Session> SceneList::open(std::size_t entry) {
  current_ = entry;
  const fs::path& file = entries_.at(entry).file;
  if (is_run(file)) return std::make_unique<Recording>(file);
  const std::string ending = file.extension().string();
  if (std::error_code error; fs::exists(file, error) && ending != ".json")
    throw Error(file.string() +
                ": not a scene; expected a scene file (.json) or the folder of a finished run");
  return std::make_unique<Simulation>(file);
}

std::size_t SceneList::neighbor(int by) const {
  const std::size_t count = entries_.size();
  if (count == 0) return 0;
  if (current_ >= count) return by > 0 ? 0 : count - 1;
  return (current_ + count + static_cast<std::size_t>(static_cast<long>(count) + by)) % count;
}

}  // namespace souple::viewer
