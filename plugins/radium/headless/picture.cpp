#include "plugins/radium/headless/picture.h"

#include <png.h>
#include <souple/error.h>

namespace souple::radium {

void write_png(const std::string& file, const Picture& picture) {
  std::vector<unsigned char> opaque;
  opaque.reserve(3 * picture.width * picture.height);
  for (std::size_t i = 0; i < picture.pixels.size(); i += 4)
    opaque.insert(opaque.end(), &picture.pixels[i], &picture.pixels[i] + 3);
  png_image image{};
  image.version = PNG_IMAGE_VERSION;
  image.width = static_cast<png_uint_32>(picture.width);
  image.height = static_cast<png_uint_32>(picture.height);
  image.format = PNG_FORMAT_RGB;
  if (png_image_write_to_file(&image, file.c_str(), 0, opaque.data(), 0, nullptr) == 0)
    throw Error(file + ": " + image.message);
}

}  // namespace souple::radium
