#pragma once

#include "souple/math/vec3.h"

#include <cstddef>
#include <filesystem>
#include <vector>

namespace souple::render {

/// Radiance of all directions, as a panorama: longitude along the width, latitude along the height.
struct Panorama {
  int width = 0, height = 0;
  std::vector<Vec3f> radiance;  ///< linear red, green, blue; width * height, rows from the top

  const Vec3f& at(int x, int y) const {
    return radiance[static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
                    static_cast<std::size_t>(x)];
  }
};

/// Reads a picture in the Radiance format (.hdr: RGBE, with or without run lengths), averaged over blocks of pixels to
/// at most 2048 x 1024. Throws Error for a file that is not one, is damaged, or has a side above 16384 pixels.
Panorama read_hdr(const std::filesystem::path& file);

}  // namespace souple::render
