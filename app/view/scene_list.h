#pragma once

#include "app/find_scene.h"
#include "app/view/session.h"

#include <cstddef>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

namespace souple::viewer {

/// Entries that the viewer can show: the shipped scenes, and every scene or run opened since.
class SceneList {
 public:
  explicit SceneList(std::vector<app::ShippedScene> scenes) : entries_(std::move(scenes)) {}

  const std::vector<app::ShippedScene>& entries() const { return entries_; }
  /// The entry opened last, successfully or not; entries().size() before the first.
  std::size_t current() const { return current_; }

  /// Opens a scene file, a finished run's folder or its run.json, and adds it to the list. Throws Error.
  std::unique_ptr<Session> open(const std::filesystem::path& path);
  std::unique_ptr<Session> open(std::size_t entry);
  /// The entry at an offset of `by` from the current one; wraps around at the ends.
  std::size_t neighbor(int by) const;

 private:
  std::vector<app::ShippedScene> entries_;
  std::size_t current_ = std::size_t(-1);
};

}  // namespace souple::viewer
