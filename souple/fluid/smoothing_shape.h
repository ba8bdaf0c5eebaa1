#pragma once

namespace souple {

/// How the weight of a neighbour falls with its distance: W(r) ~ value(r / h), grad W ~ slope(r / h); see
/// kernels/shapes.h.
enum class SmoothingShape { wendland, poly6_spiky, cubic_spline };

}  // namespace souple
