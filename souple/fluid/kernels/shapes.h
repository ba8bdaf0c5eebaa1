#pragma once

#include "souple/math/scalar.h"

// Shapes of smoothing kernels over q = r / h, with support h; T is float or a register of floats. smoothing.h
// finds the normalizing factors by sums over a lattice.
//
//   W(r)      = a value(q)
//   grad W(r) = b slope(q) d,   d = x_i - x_j,  b < 0

namespace souple::kernels {

/// Wendland's C2 kernel (Dehnen and Aly 2012, table 1): (1 - q)^4 (1 + 4 q). Its density hardly depends on
/// the packing of the particles, so that a fluid keeps its volume as it settles.
struct Wendland {
  template <class T>
  static T value(T q) {
    const T t = max(1.0f - q, T(0.0f)), t2 = t * t;
    return t2 * t2 * (1.0f + 4.0f * q);
  }
  /// The kernel's own derivative: dW/dr / r = -20 / h^2 (1 - q)^3.
  template <class T>
  static T slope(T q) {
    const T t = max(1.0f - q, T(0.0f));
    return t * t * t;
  }
};

/// Poly6 for the density, the gradient of the spiky kernel for corrections, as in Macklin and Müller 2013. Source:
/// Müller et al. 2003, "Particle-based fluid simulation for interactive applications", equations 20 and 21.
struct Poly6Spiky {
  template <class T>
  static T value(T q) {
    const T t = max(1.0f - q * q, T(0.0f));
    return t * t * t;
  }
  template <class T>
  static T slope(T q) {
    const T t = max(1.0f - q, T(0.0f));
    return t * t / q;
  }
};

/// The cubic spline (Monaghan 1992): (1 - q)^3 - 4 (1/2 - q)^3, each term where it is positive.
struct CubicSpline {
  template <class T>
  static T value(T q) {
    const T t = max(1.0f - q, T(0.0f)), u = max(0.5f - q, T(0.0f));
    return t * t * t - 4.0f * (u * u * u);
  }
  template <class T>
  static T slope(T q) {
    const T t = max(1.0f - q, T(0.0f)), u = max(0.5f - q, T(0.0f));
    return (t * t - 4.0f * (u * u)) / q;
  }
};

/// Attraction between particles, 64 (1 - q)^3 q^3, with maximum 1 at q = 1/2 (Akinci, Akinci and Teschner 2013,
/// equation 2). Below 1/2 it is twice this minus 1, so that particles do not clump.
struct Cohesion {
  /// The force over q.
  template <class T>
  static T slope(T q) {
    const T t = max(1.0f - q, T(0.0f)), a = t * q, c = 64.0f * (a * a * a);
    return select(q < T(0.5f), 2.0f * c - 1.0f, c) / q;
  }
};

}  // namespace souple::kernels
