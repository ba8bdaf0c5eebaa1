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

  /// Uploads changed data and frees buffers of removed objects. Call once per picture.
  void update(std::span<const Spheres> spheres);
  /// Draws the spheres given to `update`: for target depth those that cast shadows, for pick those that can
  /// be picked.
  void draw(const PassContext& context);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace souple::render
