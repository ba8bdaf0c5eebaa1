#pragma once

#include "render/subject.h"

#include <vector>

namespace souple::render {

/// How much ropes are stretched: per body of the subject, per point, the larger strain of its two segments;
/// empty for what is no rope. The subject has to be of a world, whose constraints know the rest lengths.
std::vector<std::vector<float>> rope_strains(const Subject& subject);

}  // namespace souple::render
