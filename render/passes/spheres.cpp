#include "render/passes/spheres.h"

namespace souple::render {

struct SpheresPass::Impl {};
SpheresPass::SpheresPass() = default;
SpheresPass::~SpheresPass() = default;

void SpheresPass::update(std::span<const Spheres> /*spheres*/) {}
void SpheresPass::draw(const PassContext& /*context*/) {}

}  // namespace souple::render
