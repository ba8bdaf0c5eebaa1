#pragma once

#include "render/draw_list.h"
#include "render/vertex_colours.h"

#include <string>
#include <vector>

namespace souple::render {

/// Says what the colours of a picture mean: lines of words in the top left corner.
class Legend {
 public:
  void clear() { labels_.clear(); }
  void title(std::string text);
  /// Words on this colour.
  void entry(PackedColour colour, std::string text);
  /// What colours from 0 to `largest` mean, hottest first.
  void scale(const HeatScale& heat, float largest, const std::string& unit);

  const std::vector<Label>& labels() const { return labels_; }

 private:
  void add(std::string text, const Colour& colour, const Colour& background);

  std::vector<Label> labels_;
};

/// Linear light of a packed colour.
Colour unpack(PackedColour colour);

/// Three digits that matter: "0.0123", "12.3", "123000".
std::string short_number(double value);

}  // namespace souple::render
