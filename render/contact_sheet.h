#pragma once

#include "render/image.h"

#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace souple::render {

/// Pictures of equal size on one page, row by row, with thin gaps; unused cells stay white. Throws Error for
/// no picture, too many, or different sizes.
Image contact_sheet(std::span<const Image> pictures, int columns, int rows);

/// Selects frames out of 1 to `frames` for a sheet of `cells`: the first, the last, and evenly spaced ones
/// between. Ascending. Every frame once where there are at most as many frames as cells; only the last for
/// one cell.
std::vector<std::uint64_t> sheet_frames(std::uint64_t frames, std::size_t cells);

}  // namespace souple::render
