#include "render/passes/labels.h"

namespace souple::render {

struct LabelsPass::Impl {};
LabelsPass::LabelsPass() = default;
LabelsPass::~LabelsPass() = default;

void LabelsPass::draw(std::span<const Label> /*labels*/, int /*width*/, int /*height*/) {}

}  // namespace souple::render
