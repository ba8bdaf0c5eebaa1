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

  /// Uploads changes and deletes the buffers of removed surfaces. Once per picture.
  void update(std::span<const Surface> surfaces);
  /// Draws the surfaces of the last `update`. Targets depth and sunlight include only surfaces that cast a shadow.
  /// Target pick includes those that can be picked: their fragments write (pick, 0), and the CPU finds the vertex.
  void draw(const PassContext& context);
  bool has_glass() const;           ///< the targets of glass would draw something
  bool glass_casts_shadow() const;  ///< target sunlight would draw something

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace souple::render
