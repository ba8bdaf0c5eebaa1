#pragma once

#include "render/passes/pass_context.h"

#include <cstdint>
#include <memory>
#include <span>

namespace souple::render {

/// Triangle meshes.
class SurfacesPass {
 public:
  SurfacesPass();
  ~SurfacesPass();

  /// Uploads what has changed and drops the buffers of what is gone. Once per picture.
  void update(std::span<const Surface> surfaces);
  /// Those that were given to `update`; of target depth those that cast a shadow, of target pick those that
  /// can be picked: their fragments write (pick, 0), the vertex is found on the CPU.
  void draw(const PassContext& context);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace souple::render
