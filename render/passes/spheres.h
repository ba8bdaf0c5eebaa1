#pragma once

#include "render/passes/pass_context.h"

#include <memory>
#include <span>

namespace souple::render {

/// Balls as ray-cast impostors with exact depth.
class SpheresPass {
 public:
  SpheresPass();
  ~SpheresPass();

  /// Uploads changes and deletes the buffers of removed balls. Once per picture.
  void update(std::span<const Spheres> spheres);
  /// Draws the balls of the last `update`. Target depth includes only those that cast a shadow, target pick
  /// those that can be picked.
  void draw(const PassContext& context);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace souple::render
