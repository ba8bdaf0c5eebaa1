#pragma once

#include "render/subject.h"

#include <vector>

namespace souple::render {

/// Strain of ropes: per body of the subject and per point, the larger strain of its two segments; empty for
/// other bodies. The subject must be of a world, whose constraints store the rest lengths.
std::vector<std::vector<float>> rope_strains(const Subject& subject);

}  // namespace souple::render
