#include "app/sweep/sheet.h"

#include "render/contact_sheet.h"
#include "render/image.h"
#include "souple/error.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace souple::app {

namespace {

constexpr int longest = 16000;  // a side of the page [pixels]
constexpr int most_columns = longest / (sheet_cell_width + 8), most_rows = longest / (sheet_cell_height + 8);

int columns_for(const Sweep& sweep) {
  std::size_t values = 1, settings = 0;
  for (const SweepSetting& setting : sweep.plan.settings()) {
    if (setting.values.size() < 2) continue;
    values = setting.values.size();
    ++settings;
  }
  const std::size_t runs = sweep.plan.runs();
  const std::size_t rows = (runs + values - 1) / values;
  if (settings > 1 && values <= std::size_t(most_columns) && rows <= std::size_t(most_rows))
    return static_cast<int>(values);
  const int square = static_cast<int>(std::ceil(std::sqrt(static_cast<double>(runs))));
  return std::min(square, most_columns);
}

/// Blank where a run has no picture, or one of another size.
render::Image picture_of(const Sweep& sweep, std::uint64_t run, bool& found) {
  const std::filesystem::path file = sweep.folder_of(run) / run_picture_name;
  std::error_code error;
  if (std::filesystem::exists(file, error)) {
    try {
      render::Image image = render::read_png(file);
      if (image.width == sheet_cell_width && image.height == sheet_cell_height) {
        found = true;
        return image;
      }
    } catch (const Error&) {  // damaged
    }
  }
  render::Image blank(sheet_cell_width, sheet_cell_height);
  std::fill(blank.pixels.begin(), blank.pixels.end(), std::uint8_t{255});
  return blank;
}

}  // namespace

bool write_sheet(const Sweep& sweep) {
  const int columns = columns_for(sweep);
  const auto runs = static_cast<std::int64_t>(sweep.plan.runs());
  const std::int64_t rows = (runs + columns - 1) / columns;
  if (rows > most_rows) return false;
  bool found = false;
  std::vector<render::Image> pictures;
  for (std::uint64_t run = 1; run <= sweep.plan.runs(); ++run)
    pictures.push_back(picture_of(sweep, run, found));
  if (!found) return false;
  render::write_png(sweep.out / sheet_name, render::contact_sheet(pictures, columns, static_cast<int>(rows)));
  return true;
}

}  // namespace souple::app
