#pragma once

#include "app/sweep/folder.h"

namespace souple::app {

/// Writes out/sheet.png: the last picture of each run, blank where there is none. Columns are the values of the last setting
/// with several values, unless the page would be too wide or too high. Returns false where no run has a picture. Throws Error
/// where the file cannot be written.
bool write_sheet(const Sweep& sweep);

inline constexpr int sheet_cell_width = 480, sheet_cell_height = 270;  ///< pixels
inline constexpr const char* sheet_name = "sheet.png";
inline constexpr const char* run_picture_name = "picture.png";

}  // namespace souple::app
