#include "render/image.h"
#include "render/palette_image.h"
#include "souple/error.h"
#include "souple/files/atomic_file.h"

#include <cstring>
#include <png.h>
#include <string>
#include <vector>

#include <fmt/format.h>

namespace souple::render {

namespace {

/// libpng's simplified interface reports errors by value, without longjmp; this frees its memory.
class Png {
 public:
  Png() {
    std::memset(&image, 0, sizeof image);
    image.version = PNG_IMAGE_VERSION;
  }
  ~Png() { png_image_free(&image); }
  Png(const Png&) = delete;
  Png& operator=(const Png&) = delete;

  png_image image;
};

std::vector<std::uint8_t> without_alpha(const Image& image) {
  std::vector<std::uint8_t> rgb;
  rgb.reserve(image.pixels.size() / 4 * 3);
  for (std::size_t i = 0; i < image.pixels.size(); i += 4) {
    rgb.insert(rgb.end(), &image.pixels[i], &image.pixels[i] + 3);
  }
  return rgb;
}

std::string encode(const Image& image, int palette) {
  Png png;
  png.image.width = png_uint_32(image.width);
  png.image.height = png_uint_32(image.height);
  std::vector<std::uint8_t> samples;
  PaletteImage reduced;
  const void* colors = nullptr;
  if (palette > 0) {
    reduced = reduce_colors(image, palette);
    samples = std::move(reduced.indices);
    colors = reduced.colors.data();
    png.image.format = PNG_FORMAT_RGB_COLORMAP;
    png.image.colormap_entries = png_uint_32(reduced.colors.size() / 3);
  } else {
    samples = without_alpha(image);
    png.image.format = PNG_FORMAT_RGB;
  }
  png_alloc_size_t size = 0;
  std::string bytes;
  // The first call returns the size. Both calls encode; encoding a picture takes milliseconds.
  bool good = png_image_write_to_memory(&png.image, nullptr, &size, 0, samples.data(), 0, colors) != 0;
  if (good) {
    bytes.resize(size);
    good = png_image_write_to_memory(&png.image, bytes.data(), &size, 0, samples.data(), 0, colors) != 0;
  }
  if (!good)
    throw Error(
        fmt::format("{} x {} picture: not encoded: {}", image.width, image.height, png.image.message));
  bytes.resize(size);
  return bytes;
}

}  // namespace

void write_png(const std::filesystem::path& file, const Image& image, int palette) {
  if (image.width < 1 || image.height < 1) {
    throw Error(fmt::format("{}: a picture of {} x {} pixels; expected at least 1 x 1", file.string(),
                            image.width, image.height));
  }
  if (palette < 0 || palette > 256) {
    throw Error(fmt::format("{}: a palette of {} colors; expected at most 256", file.string(), palette));
  }
  write_file_atomically(file, encode(image, palette));
}

Image read_png(const std::filesystem::path& file) {
  constexpr png_uint_32 largest = 16384;  // a header may claim any size
  const std::string bytes = read_whole_file(file);
  Png png;
  if (png_image_begin_read_from_memory(&png.image, bytes.data(), bytes.size()) == 0) {
    throw Error(fmt::format("{}: not a PNG picture: {}", file.string(), png.image.message));
  }
  if (png.image.width > largest || png.image.height > largest) {
    throw Error(fmt::format("{}: {} x {} pixels; expected at most {} a side", file.string(), png.image.width,
                            png.image.height, largest));
  }
  png.image.format = PNG_FORMAT_RGBA;
  Image image(int(png.image.width), int(png.image.height));
  if (png_image_finish_read(&png.image, nullptr, image.pixels.data(), 0, nullptr) == 0) {
    throw Error(fmt::format("{}: a damaged PNG picture: {}", file.string(), png.image.message));
  }
  return image;
}

}  // namespace souple::render
