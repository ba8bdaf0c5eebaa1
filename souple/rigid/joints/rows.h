#pragma once

#include "souple/rigid/joints/parts.h"

#include <array>
#include <cmath>
#include <cstdint>

namespace souple::joint {

/// Where a joint's frames are in the world.
struct Ends {
  Vec3d center_a, center_b;  ///< of mass [m]
  Vec3d point_a, point_b;    ///< m
  Mat3d axes_a, axes_b;      ///< the joint's axes, as columns
  /// Angles are counted over several turns: the last known value of each [rad].
  std::array<double, 2> angle{};
};

/// A scalar function of two poses: its value, and its gradient by the positions and rotations of both bodies. A
/// positional impulse lambda pushes a body by lambda times `linear` and turns it by lambda times `angular`.
struct Row {
  Vec3d linear_a{}, angular_a{}, linear_b{}, angular_b{};
  double value = 0;  ///< m or rad
};

/// Law that determines the value of a row.
struct RowLaw {
  enum class Kind : std::uint8_t {
    spring,  ///< pulled to `low`; rigid without compliance
    range,   ///< not below `low`, not above `high`
    speed,   ///< changes by `low` per second
  };
  Kind kind = Kind::spring;
  double low = 0, high = 0;
  double compliance = 0, damping = 0;
  double max_force = unlimited;  ///< of spring and speed
  bool servo = false;  ///< a rigid spring that approaches at a speed from which `max_force` can stop it
};

/// A row along a unit direction, acting at the point of b.
inline Row row_across(const Ends& ends, const Vec3d& direction) {
  return {-direction, -cross(ends.point_b - ends.center_a, direction), direction,
          cross(ends.point_b - ends.center_b, direction), dot(ends.point_b - ends.point_a, direction)};
}

/// A row of rotations about `axis`.
inline Row row_about(const Vec3d& axis, double value) {
  return {{}, -axis, {}, axis, value};
}

/// The value next to `last` that differs from `angle` by full turns.
inline double next_turn(double angle, double last) {
  return last + std::remainder(angle - last, 2 * pi);
}

/// The rows of one joint. Their number follows from its description, not from poses.
struct Rows {
  static constexpr int most = 10;
  std::array<Row, most> row{};
  std::array<RowLaw, most> law{};
  int count = 0;
  /// Whether the first three rows hold the points together, along the axes of the world.
  bool has_point = false;

  void add(const Row& r, const RowLaw& l) {
    const auto i = static_cast<std::size_t>(count++);
    row[i] = r, law[i] = l;
  }
  /// The limits, spring and motor of a degree of freedom.
  void add_axis(const Row& r, const Axis& axis);
  void add_limits(const Row& r, const Limits& limits);
  /// Holds the points together. C = point_b - point_a, dC = dx + dtheta x r.
  void add_point(const Ends& ends, double compliance, double damping);
  /// Holds the axes of b to `target` in the axes of a: C = 2 v. Here (v, w) is the rotation from the target, in the
  /// axes of the target at a. With dv = (w dtheta + dtheta x v) / 2, dC_k = dtheta . (w e_k + v x e_k).
  void add_rotation(const Ends& ends, const Quatd& target, const RowLaw& held_by);
  /// Holds the first axes parallel: C = (x_b . y_a, x_b . z_a).
  void add_parallel_axes(const Ends& ends, double compliance, double damping);
};

inline void Rows::add_limits(const Row& r, const Limits& limits) {
  if (limits.low > -unlimited || limits.high < unlimited)
    add(r, {RowLaw::Kind::range, limits.low, limits.high, limits.compliance, limits.damping});
}

inline void Rows::add_axis(const Row& r, const Axis& axis) {
  add_limits(r, axis.limits);
  if (axis.spring)
    add(r, {RowLaw::Kind::spring, axis.spring->rest, 0, axis.spring->compliance, axis.spring->damping});
  if (!axis.motor) return;
  const Motor& motor = *axis.motor;
  if (motor.kind == Motor::Target::velocity)
    add(r, {RowLaw::Kind::speed, motor.target, 0, 0, 0, motor.max_force});
  else
    add(r, {RowLaw::Kind::spring, motor.target, 0, motor.compliance, motor.damping, motor.max_force, true});
}

inline void Rows::add_point(const Ends& ends, double compliance, double damping) {
  const Vec3d ra = ends.point_a - ends.center_a, rb = ends.point_b - ends.center_b;
  const Mat3d e = Mat3d::identity();
  for (int k = 0; k < 3; ++k) {
    const Vec3d& n = e.column[k];
    add({-n, -cross(ra, n), n, cross(rb, n), dot(ends.point_b - ends.point_a, n)},
        {RowLaw::Kind::spring, 0, 0, compliance, damping});
  }
  has_point = true;
}

/// The unit quaternion of a rotation matrix (Shepperd 1978, "Quaternion from rotation matrix").
inline Quatd quaternion_of(const Mat3d& m) {
  const double t = trace(m);
  if (t > 0) {
    const double w = std::sqrt(1 + t) / 2, f = 1 / (4 * w);
    return {(m(2, 1) - m(1, 2)) * f, (m(0, 2) - m(2, 0)) * f, (m(1, 0) - m(0, 1)) * f, w};
  }
  const int i = m(0, 0) > m(1, 1) ? (m(0, 0) > m(2, 2) ? 0 : 2) : (m(1, 1) > m(2, 2) ? 1 : 2);
  const int j = (i + 1) % 3, k = (i + 2) % 3;
  Vec3d v;
  v[i] = std::sqrt(std::fmax(1 + m(i, i) - m(j, j) - m(k, k), 0.0)) / 2;
  const double f = 1 / (4 * v[i]);
  v[j] = (m(j, i) + m(i, j)) * f, v[k] = (m(k, i) + m(i, k)) * f;
  return {v.x, v.y, v.z, (m(k, j) - m(j, k)) * f};
}

/// From the axes of a to those of b, in the axes of a, with w >= 0.
inline Quatd relative_rotation(const Ends& ends) {
  const Quatd q = quaternion_of(transpose(ends.axes_a) * ends.axes_b);
  return q.w < 0 ? Quatd{-q.x, -q.y, -q.z, -q.w} : q;
}

inline void Rows::add_rotation(const Ends& ends, const Quatd& target, const RowLaw& held_by) {
  const Mat3d held = ends.axes_a * rotation_matrix(target);
  Quatd q = quaternion_of(transpose(held) * ends.axes_b);
  if (q.w < 0) q = {-q.x, -q.y, -q.z, -q.w};
  const Vec3d v{q.x, q.y, q.z};
  const Mat3d e = Mat3d::identity();
  for (int k = 0; k < 3; ++k)
    add(row_about(held * (e.column[k] * q.w + cross(v, e.column[k])), 2 * v[k]), held_by);
}

inline void Rows::add_parallel_axes(const Ends& ends, double compliance, double damping) {
  const Vec3d& x = ends.axes_b.column[0];
  for (int k = 1; k < 3; ++k) {
    const Vec3d& side = ends.axes_a.column[k];
    add(row_about(cross(x, side), dot(x, side)), {RowLaw::Kind::spring, 0, 0, compliance, damping});
  }
}

}  // namespace souple::joint
