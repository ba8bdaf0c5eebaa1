#include "render/passes/pick.h"

namespace souple::render {

struct PickPass::Impl {};
PickPass::PickPass() = default;
PickPass::~PickPass() = default;

Picked PickPass::pick(const DrawList& /*list*/, SurfacesPass& /*surfaces*/, SpheresPass& /*spheres*/,
                      const PassContext& /*context*/, int /*x*/, int /*y*/) {
  return {};
}
PickImage PickPass::image(const DrawList& /*list*/, SurfacesPass& /*surfaces*/, SpheresPass& /*spheres*/,
                          const PassContext& /*context*/) {
  return {};
}

}  // namespace souple::render
