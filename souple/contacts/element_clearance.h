#pragma once

#include "souple/collision/shapes.h"

#include <cmath>
#include <variant>

// Triangles and edges between particles in contact with a collider that is round: the circle of radius R around
// an element sags below its corners. If the corners keep the distance
//
//   d = sqrt((c + t r)^2 + R^2) - c,    c: radius of curvature of the surface,  t r: clearance of the element,
//
// the element keeps the distance t r everywhere, and needs no contact of its own.

namespace souple {

/// Between its corners an element keeps a distance of this part of its smallest particle radius.
constexpr double element_clearance_part = 0.25;
/// R is increased by this factor, for stretch.
constexpr double stretch_allowance = 1.1;
/// Elements that are larger, as a part of c, get contacts of their own: their corners would hover visibly (2 % of c).
constexpr double coarse_element_part = 0.2;

/// The smallest radius of curvature of a shape's convex surface parts; 0 for shapes with edges, and where it is
/// unknown. [m]
inline double curvature_radius(const Shape& shape) {
  if (const auto* sphere = std::get_if<Sphere>(&shape)) return double(sphere->radius);
  if (const auto* capsule = std::get_if<Capsule>(&shape)) return double(capsule->radius);
  return 0;
}

/// Distance that a particle of radius r keeps from a surface of radius of curvature c (0: flat or unknown). R:
/// radius of the smallest circle around its largest element; coarse ones count as far as the limit above. [m]
inline double corner_distance(double r, double R, double c) {
  if (!(c > 0)) return r;
  const double inner = c + element_clearance_part * r;
  const double wide = stretch_allowance * std::fmin(R, coarse_element_part * c);
  return std::fmax(r, std::sqrt(inner * inner + wide * wide) - c);
}

}  // namespace souple
