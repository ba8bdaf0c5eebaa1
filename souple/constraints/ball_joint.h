#pragma once

#include "souple/constraints/constraint.h"

namespace souple {

/// Makes two points coincide, and lets their bodies rotate freely about them. Each point is embedded in
/// particles of its body: a point of a segment, a triangle or a tet in barycentric coordinates.
///
///   a = x_0 + sum_{1 <= i < m} b_i (x_i - x_0),  b alike from the other n particles,  C = |a - b|  [m]
///
/// Energy 1/2 k C^2 with k [N/m]; compliance alpha = 1/k [m/N]. For coincident points, the satisfied state,
/// the direction is undefined and the gradient is zero. All particles must differ; bodies that share a
/// particle are joined by it already. Use ConeLimit and TwistLimit to limit the rotation.
template <int m, int n>
struct BallJointBetween {
  static_assert(m >= 1 && n >= 1 && m + n > 2, "two single particles: use Distance with length 0");
  static constexpr const char* name = "ball_joint";
  static constexpr int arity = m + n;
  static constexpr Sense sense = Sense::equality;

  template <class T>
  struct Params {
    /// Barycentric weights of all particles but the first of each point, whose weight is 1 minus the others.
    T weight[m + n - 2];
  };

  /// Joint of two segments: connects the points of both that are nearest to `pivot`.
  static Params<float> from_rest(const Vec3d (&x)[4], const Vec3d& pivot) requires(m == 2 && n == 2) {
    const auto foot = [&pivot](const Vec3d& a, const Vec3d& b) {
      const double ee = dot(b - a, b - a);
      return static_cast<float>(ee > 0 ? std::fmin(std::fmax(dot(pivot - a, b - a) / ee, 0.0), 1.0) : 0.0);
    };
    return {{foot(x[0], x[1]), foot(x[2], x[3])}};
  }

  template <class T>
  static T evaluate(const Vec3<T> (&x)[arity], const Params<T>& p, Vec3<T> (&gradient)[arity]) {
    Vec3<T> d = x[0] - x[m];
    T first{1}, second{1};
    for (int i = 1; i < m; ++i) {
      d += (x[i] - x[0]) * p.weight[i - 1];
      first = first - p.weight[i - 1];
    }
    for (int j = 1; j < n; ++j) {
      d -= (x[m + j] - x[m]) * p.weight[m + j - 2];
      second = second - p.weight[m + j - 2];
    }
    const T l = sqrt(dot(d, d));
    const Vec3<T> direction = d * (T(1) / max(l, T(1e-18f)));
    gradient[0] = direction * first;
    gradient[m] = -(direction * second);
    for (int i = 1; i < m; ++i) gradient[i] = direction * p.weight[i - 1];
    for (int j = 1; j < n; ++j) gradient[m + j] = -(direction * p.weight[m + j - 2]);
    return l;
  }
};

/// Connects a point of the segment x0 x1 to a point of the segment x2 x3.
using BallJoint = BallJointBetween<2, 2>;

}  // namespace souple
