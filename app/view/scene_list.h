#pragma once

#include "app/find_scene.h"
#include "app/view/session.h"

#include <cstddef>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

namespace souple::viewer {

/// The scenes and runs offered by the viewer: the shipped scenes and those opened since its start.
class SceneList {
 public:
  explicit SceneList(std::vector<app::ShippedScene> scenes) : entries_(std::move(scenes)) {}

  const std::vector<app::ShippedScene>& entries() const { return entries_; }
  /// The entry opened last, even if that failed; entries().size() before the first.
  std::size_t current() const { return current_; }

  /// Opens a scene file, a finished run's folder, or its run.json, and adds it to the list. Throws Error.
  std::unique_ptr<Session> open(const std::filesystem::path& path);
  std::unique_ptr<Session> open(std::size_t entry);
  /// The entry `by` positions after the current one, cyclically.
  std::size_t neighbor(int by) const;

 private:
  std::vector<app::ShippedScene> entries_;
  std::size_t current_ = std::size_t(-1);
};

}  // namespace souple::viewer
