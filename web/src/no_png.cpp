#include "render/image.h"
#include "souple/error.h"

#include <fmt/format.h>

// The browser's build has no libpng: it saves pictures by the canvas, and prints none on cloth.

namespace souple::render {

Image read_png(const std::filesystem::path& file) {
  throw Error(fmt::format("{}: the page prints no pictures on cloth; expected a pattern such as checker",
                          file.string()));
}

}  // namespace souple::render
