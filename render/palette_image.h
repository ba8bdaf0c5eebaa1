#pragma once

#include "render/image.h"

namespace souple::render {

/// A picture with a palette.
struct PaletteImage {
  std::vector<std::uint8_t> indices;  ///< width * height, rows from the top
  std::vector<std::uint8_t> colors;   ///< R, G, B of each color
};

/// Chooses up to `count` (in [1, 256]) colors by median cut and improves them with Lloyd's method. Diffuses each
/// pixel's error to its neighbors (Floyd and Steinberg 1976). Alpha is dropped. Deterministic.
PaletteImage reduce_colors(const Image& image, int count);

}  // namespace souple::render
