#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <vector>

namespace souple::render {

/// A picture: sRGB-encoded R, G, B, A bytes, rows from the top.
struct Image {
  int width = 0, height = 0;
  std::vector<std::uint8_t> pixels;  ///< 4 * width * height

  Image() = default;
  Image(int width_, int height_)
      : width(width_), height(height_), pixels(4 * std::size_t(width_) * std::size_t(height_)) {}
  std::uint8_t* at(int x, int y) {
    return &pixels[4 * (std::size_t(y) * std::size_t(width) + std::size_t(x))];
  }
  const std::uint8_t* at(int x, int y) const {
    return &pixels[4 * (std::size_t(y) * std::size_t(width) + std::size_t(x))];
  }
  bool operator==(const Image&) const = default;
};

/// Writes an opaque PNG, completely or not at all (NAME.part, then renamed). Equal pictures give equal files.
/// `palette` > 0 first reduces the picture to that many colors (at most 256), dithered: a third of the size.
/// Throws Error when the file cannot be written.
void write_png(const std::filesystem::path& file, const Image& image, int palette = 0);
/// Throws Error for a file that is not a PNG.
Image read_png(const std::filesystem::path& file);

/// Averages blocks in linear light to `width` x `height`; neither may exceed that of `image`.
Image downscale(const Image& image, int width, int height);

/// Copies `from` into `to` with its top left corner at (x, y); clips parts outside.
void paste(const Image& from, Image& to, int x, int y);

}  // namespace souple::render
