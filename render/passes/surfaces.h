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

  /// Uploads changed data and frees buffers of removed objects. Call once per picture.
  void update(std::span<const Surface> surfaces);
  /// Draws the surfaces given to `update`: for target depth those that cast shadows, for pick those that can
  /// be picked. Picked fragments write (pick, 0); the CPU finds the vertex.
  void draw(const PassContext& context);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace souple::render
