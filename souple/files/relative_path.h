#pragma once

#include <filesystem>
#include <string>

namespace souple {

/// Whether a relative path stays inside its folder: a damaged or foreign file must not cause access to files
/// elsewhere.
inline bool stays_inside_folder(const std::string& text) {
  const std::filesystem::path path(text);
  if (text.empty() || text.find('\0') != std::string::npos || path.has_root_path()) return false;
  for (const auto& part : path) {
    if (part == "..") return false;
  }
  return true;
}

}  // namespace souple
