#pragma once

#include "render/draw_list.h"
#include "render/vertex_colors.h"

#include <string>
#include <vector>

namespace souple::render {

/// Explains the colors of a picture: lines of text in the top left corner.
class Legend {
 public:
  void clear() { labels_.clear(); }
  void title(std::string text);
  /// Text on a background of this color.
  void entry(PackedColor color, std::string text);
  /// The scale of colors from 0 to `largest`, hottest first.
  void scale(const HeatScale& heat, float largest, const std::string& unit);

  const std::vector<Label>& labels() const { return labels_; }

 private:
  void add(std::string text, const Color& color, const Color& background);

  std::vector<Label> labels_;
};

/// Converts a packed color to linear light.
Color unpack(PackedColor color);

/// Rounds to three significant digits: "0.0123", "12.3", "123000".
std::string short_number(double value);

}  // namespace souple::render
