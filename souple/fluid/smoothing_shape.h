#pragma once

namespace souple {

/// Shape of the smoothing kernel: W(r) ~ value(r / h), grad W ~ slope(r / h); see kernels/shapes.h. The
/// support h is two spacings, except for wide_wendland.
enum class SmoothingShape {
  wendland,
  poly6_spiky,
  cubic_spline,
  wide_wendland  ///< h is 2.3 spacings: half again as many neighbors, and slow flows keep moving longer
};

}  // namespace souple
