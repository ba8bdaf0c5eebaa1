#pragma once

#include "render/image.h"

#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace souple::render {

/// Pictures of one size side by side on one page, row by row, thin gaps between them; cells left over stay
/// white. Throws Error for no picture, too many, or different sizes.
Image contact_sheet(std::span<const Image> pictures, int columns, int rows);

/// Which of the frames 1 to `frames` a sheet of `cells` shows: the first, the last, and evenly between.
/// Ascending; every frame once where there are no more than cells, the last alone for one cell.
std::vector<std::uint64_t> sheet_frames(std::uint64_t frames, std::size_t cells);

}  // namespace souple::render
