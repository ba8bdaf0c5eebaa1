#include "render/contact_sheet.h"

#include "souple/error.h"

#include <algorithm>

#include <fmt/format.h>

namespace souple::render {

Image contact_sheet(std::span<const Image> pictures, int columns, int rows) {
  constexpr int gap = 4;  // pixels
  if (columns < 1 || rows < 1) {
    throw Error(fmt::format("contact sheet: {} x {} cells; expected at least 1 x 1", columns, rows));
  }
  if (pictures.empty() || pictures.size() > std::size_t(columns) * std::size_t(rows)) {
    throw Error(fmt::format(
        "contact sheet: {} pictures for {} x {} cells; expected at least 1 picture and at most one per cell",
        pictures.size(), columns, rows));
  }
  const int width = pictures[0].width, height = pictures[0].height;
  Image page(columns * width + (columns - 1) * gap, rows * height + (rows - 1) * gap);
  std::fill(page.pixels.begin(), page.pixels.end(), std::uint8_t{255});
  for (std::size_t i = 0; i < pictures.size(); ++i) {
    if (pictures[i].width != width || pictures[i].height != height) {
      throw Error(fmt::format("contact sheet: picture {} is {} x {}, the first {} x {}; expected equal sizes",
                              i + 1, pictures[i].width, pictures[i].height, width, height));
    }
    const int column = int(i) % columns, row = int(i) / columns;
    paste(pictures[i], page, column * (width + gap), row * (height + gap));
  }
  return page;
}

std::vector<std::uint64_t> sheet_frames(std::uint64_t frames, std::size_t cells) {
  const std::uint64_t count = std::min<std::uint64_t>(frames, cells);
  if (count == 1) return {frames};
  std::vector<std::uint64_t> result;
  for (std::uint64_t i = 0; i < count; ++i) {
    result.push_back(1 + (2 * i * (frames - 1) + (count - 1)) / (2 * (count - 1)));  // rounded
  }
  return result;
}

}  // namespace souple::render
