#pragma once

#include "render/passes/pass_context.h"

#include <memory>
#include <span>

namespace souple::render {

/// Lines of constant width, as quads with smooth edges, blended over linear color. The renderer has switched
/// the depth test on or off; lines do not write depth.
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
