#pragma once

#include <filesystem>
#include <string>

namespace souple {

/// True for a path that cannot lead out of the folder it is relative to: a damaged or foreign file must not
/// make us touch others.
inline bool stays_inside_folder(const std::string& text) {
  const std::filesystem::path path(text);
  if (text.empty() || text.find('\0') != std::string::npos || path.has_root_path()) return false;
  for (const auto& part : path) {
    if (part == "..") return false;
  }
  return true;
}

}  // namespace souple
