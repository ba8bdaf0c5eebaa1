#pragma once

#include "souple/constraints/constraint.h"

namespace souple {

/// Keeps a particle at a target, which the caller may move. C = |x - target|  [m], with positions relative to
/// the target. Energy 1/2 k C^2 with k [N/m]; compliance alpha = 1/k [m/N]. At the target the direction is
/// undefined: the gradient is zero.
struct Attachment {
  static constexpr const char* name = "attachment";
  static constexpr int arity = 1;
  static constexpr Sense sense = Sense::equality;
  static constexpr bool unit_gradients = true;

  template <class T>
  struct Params {
    Vec3<T> target;  ///< m, in the world
  };

  template <class T>
  static Vec3<T> origin(const Params<T>& p) {
    return p.target;
  }

  static Vec3f target(const Params<float>& p) { return p.target; }

  /// x is relative to the target.
  template <class T>
  static T evaluate(const Vec3<T> (&x)[1], const Params<T>&, Vec3<T> (&gradient)[1]) {
    const T l = sqrt(dot(x[0], x[0]));
    gradient[0] = x[0] * (T(1) / max(l, T(1e-18f)));
    return l;
  }
};

}  // namespace souple
