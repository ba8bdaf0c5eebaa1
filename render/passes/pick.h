#pragma once

#include "render/passes/pass_context.h"
#include "render/passes/spheres.h"
#include "render/passes/surfaces.h"
#include "render/renderer.h"

#include <memory>

namespace souple::render {

/// Draws who is where into integer buffers and reads them back. Surfaces and spheres were updated, and the
/// uniform block is the camera's.
class PickPass {
 public:
  PickPass();
  ~PickPass();

  Picked pick(const DrawList& list, SurfacesPass& surfaces, SpheresPass& spheres, const PassContext& context,
              int x, int y);
  PickImage image(const DrawList& list, SurfacesPass& surfaces, SpheresPass& spheres,
                  const PassContext& context);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace souple::render
