#pragma once

#include "render/draw_list.h"
#include "render/font.h"

#include <filesystem>
#include <memory>
#include <span>

namespace souple::render {

/// Text over the finished picture: writes sRGB-encoded colors into the bound framebuffer.
class LabelsPass {
 public:
  /// Uses a built-in font if this font file (TrueType) is missing.
  explicit LabelsPass(const std::filesystem::path& font = Font::default_file());
  ~LabelsPass();

  void draw(std::span<const Label> labels, int width, int height);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace souple::render
