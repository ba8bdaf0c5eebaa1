#pragma once

#include "render/passes/pass_context.h"

#include <memory>
#include <span>

namespace souple::render {

/// Lines of constant width, as quads with smooth edges, blended over linear color. Where the depth test is
/// on the renderer has switched it on, without writing depth.
class LinesPass {
 public:
  LinesPass();
  ~LinesPass();

  void draw(std::span<const Line> lines, const PassContext& context);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace souple::render
