#pragma once

#include <set>
#include <string>
#include <string_view>

namespace souple {

/// File name for an object called `name`. UTF-8 letters stay. Separators, control characters, characters that
/// Windows forbids, and a leading dot (hidden files, `..`) become `_`. `ball_0007` becomes `ball_0007_`,
/// because it would look like a frame of a sequence `ball`. At most 100 bytes.
std::string safe_file_name(std::string_view name);

/// Generates safe file names that differ even on a case-insensitive file system: ball, ball-2, ball-3, ...
class FileNames {
 public:
  std::string add(std::string_view name);

 private:
  std::set<std::string> taken_;  ///< in lower case
};

}  // namespace souple
