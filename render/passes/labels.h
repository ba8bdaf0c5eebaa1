#pragma once

#include "render/draw_list.h"

#include <memory>
#include <span>

namespace souple::render {

/// Text over the finished picture: writes sRGB-encoded colours into the framebuffer that is bound.
class LabelsPass {
 public:
  LabelsPass();
  ~LabelsPass();

  void draw(std::span<const Label> labels, int width, int height);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace souple::render
