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

  /// Uploads what has changed and drops the buffers of what is gone. Once per picture.
  void update(std::span<const Spheres> spheres);
  /// Those that were given to `update`; of target depth those that cast a shadow, of target pick those that
  /// can be picked.
  void draw(const PassContext& context);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace souple::render
