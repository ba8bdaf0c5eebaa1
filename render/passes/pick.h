#pragma once

#include "render/passes/liquid_splats.h"
#include "render/passes/pass_context.h"
#include "render/passes/spheres.h"
#include "render/passes/surfaces.h"
#include "render/renderer.h"

#include <memory>

namespace souple::render {

/// The passes of pickable objects, all updated.
struct Pickable {
  SurfacesPass& surfaces;
  SpheresPass& spheres;
  const LiquidSplats& liquids;
};

/// Draws pick and element into integer buffers and reads them back. The uniform block is the camera's.
class PickPass {
 public:
  PickPass();
  ~PickPass();

  Picked pick(const DrawList& list, const Pickable& pickable, const PassContext& context, int x, int y);
  PickImage image(const DrawList& list, const Pickable& pickable, const PassContext& context);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace souple::render
