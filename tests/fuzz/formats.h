#pragma once

#include <string_view>

/// One function per format: parses the bytes. It returns or throws souple::Error; any other behavior
/// is a bug.
namespace souple::fuzz {

struct Format {
  std::string_view name;  ///< name of the format and of its folder in corpus/
  void (*parse)(std::string_view bytes);
};

/// Every format that has a fuzz target. To add one: its function and its line in formats.cpp, its name in
/// CMakeLists.txt, and small valid files in corpus/NAME/.
const Format* find_format(std::string_view name);

}  // namespace souple::fuzz
