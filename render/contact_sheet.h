#pragma once

#include "render/image.h"

#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace souple::render {

/// Arranges pictures of one size on a page, row by row, with thin gaps; unused cells stay white. Throws Error
/// for no picture, too many pictures, or different sizes.
Image contact_sheet(std::span<const Image> pictures, int columns, int rows);

/// The frames, of 1 to `frames`, that a sheet of `cells` shows: the first, the last, and evenly spaced ones
/// between, ascending. Every frame once if there are no more than cells; only the last for one cell.
std::vector<std::uint64_t> sheet_frames(std::uint64_t frames, std::size_t cells);

}  // namespace souple::render
