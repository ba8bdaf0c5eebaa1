#pragma once

#include <set>
#include <string>
#include <string_view>

namespace souple {

/// What an object called `name` is called in a folder. UTF-8 letters stay; separators, control characters and
/// what Windows forbids become `_`; so does a dot in front (hidden files, `..`). `ball_0007` becomes
/// `ball_0007_`, lest it look like a frame of a sequence `ball`. At most 100 bytes.
std::string safe_file_name(std::string_view name);

/// Gives out safe file names that differ even where a file system ignores case: ball, ball-2, ball-3, ...
class FileNames {
 public:
  std::string add(std::string_view name);

 private:
  std::set<std::string> taken_;  ///< in lower case
};

}  // namespace souple
