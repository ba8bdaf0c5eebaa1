#pragma once

#include "render/image.h"

namespace souple::render {

/// A picture of few colors.
struct PaletteImage {
  std::vector<std::uint8_t> indices;  ///< width * height, rows from the top
  std::vector<std::uint8_t> colors;   ///< R, G, B of each
};

/// Chooses up to `count` (in [1, 256]) colors by median cut, betters them by Lloyd's method, and spreads
/// what each pixel misses over its neighbors (Floyd and Steinberg 1976). Alpha is dropped. Deterministic.
PaletteImage reduce_colors(const Image& image, int count);

}  // namespace souple::render
