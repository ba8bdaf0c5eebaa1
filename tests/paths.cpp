#include "tests/paths.h"

namespace souple {

std::string source_path(const std::string& file) {
  return file.empty() ? SOUPLE_SOURCE_DIR : SOUPLE_SOURCE_DIR "/" + file;
}

}  // namespace souple
