#include "render/passes/lines.h"

namespace souple::render {

struct LinesPass::Impl {};
LinesPass::LinesPass() = default;
LinesPass::~LinesPass() = default;

void LinesPass::draw(std::span<const Line> /*lines*/, const PassContext& /*context*/) {}

}  // namespace souple::render
