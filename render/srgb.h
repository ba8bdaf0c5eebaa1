#pragma once

namespace souple::render {

/// The transfer function of sRGB (IEC 61966-2-1) and its inverse, on [0, 1].
float linear_of_srgb(float encoded);
float srgb_of_linear(float linear);

}  // namespace souple::render
