#pragma once

namespace souple {

/// How the weight of a neighbor falls with its distance: W(r) ~ value(r / h), grad W ~ slope(r / h); see
/// kernels/shapes.h. The support h is two spacings, but for the wide one.
enum class SmoothingShape {
  wendland,
  poly6_spiky,
  cubic_spline,
  wide_wendland  ///< h is 2.3 spacings: half as many neighbors again, and slow flows do not stop so soon
};

}  // namespace souple
