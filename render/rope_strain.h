#pragma once

#include "render/subject.h"

#include <vector>

namespace souple::render {

/// Strain of ropes: per body of the subject, per point, the larger strain of its two segments; empty for
/// other bodies. Requires a subject of a world, whose constraints hold the rest lengths.
std::vector<std::vector<float>> rope_strains(const Subject& subject);

}  // namespace souple::render
