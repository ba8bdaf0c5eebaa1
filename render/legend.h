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
  /// Adds a text about this color.
  void entry(PackedColor color, std::string text);
  /// Adds the color scale from 0 to `largest`, hottest first.
  void scale(const HeatScale& heat, float largest, const std::string& unit);

  const std::vector<Label>& labels() const { return labels_; }

 private:
  void add(std::string text, const Color& color, const Color& background);

  std::vector<Label> labels_;
};

/// Linear light of a packed color.
Color unpack(PackedColor color);

/// Three significant digits: "0.0123", "12.3", "123000".
std::string short_number(double value);

}  // namespace souple::render
