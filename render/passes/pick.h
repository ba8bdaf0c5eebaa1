#pragma once

#include "render/passes/liquid_splats.h"
#include "render/passes/pass_context.h"
#include "render/passes/spheres.h"
#include "render/passes/surfaces.h"
#include "render/renderer.h"

#include <memory>

namespace souple::render {

/// The passes with pickable objects, all updated.
struct Pickable {
  SurfacesPass& surfaces;
  SpheresPass& spheres;
  const LiquidSplats& liquids;
};

/// Draws the identities of objects into integer buffers and reads them back. Requires the camera's uniform
/// block.
class PickPass {
 public:
  PickPass();
  ~PickPass();

  Picked pick(const DrawList& list, const Pickable& things, const PassContext& context, int x, int y);
  PickImage image(const DrawList& list, const Pickable& things, const PassContext& context);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace souple::render
