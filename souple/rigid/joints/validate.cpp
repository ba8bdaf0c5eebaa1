#include "souple/error.h"
#include "souple/math/limits.h"
#include "souple/rigid/joints/joint.h"

#include <cmath>

#include <fmt/core.h>

namespace souple::joint {
namespace {

/// Refuses values, in sentences that name the joint.
struct Check {
  const std::string& name;

  [[noreturn]] void fail(const std::string& what) const {
    throw Error(fmt::format("joint '{}': {}", name, what));
  }
  void at_least_0(const char* field, double value, bool infinite = false) const {
    if (value >= 0 && (infinite || std::isfinite(value))) return;
    fail(fmt::format("{} is {:g}; expected {}number of at least 0", field, value,
                     infinite ? "a " : "a finite "));
  }
  void positive(const char* field, double value) const {
    if (!(value > 0))
      fail(fmt::format(
          "{} is {:g}; expected a number greater than 0, or infinity for a joint that never breaks", field,
          value));
  }
  void finite(const char* field, double value) const {
    if (!std::isfinite(value)) fail(fmt::format("{} is {:g}; expected a finite number", field, value));
  }
  void point(const char* field, const Vec3d& p) const {
    if (!is_within(p, range::coordinate))
      fail(fmt::format("{} is ({:g}, {:g}, {:g}); expected coordinates of at most {:g} m", field, p.x, p.y,
                       p.z, range::coordinate));
  }
  void rotation(const char* field, const Quatd& q) const {
    const double l2 = q.x * q.x + q.y * q.y + q.z * q.z + q.w * q.w;
    if (std::isfinite(l2) && l2 > 1e-12) return;
    fail(fmt::format(
        "{} is ({:g}, {:g}, {:g}, {:g}); expected a quaternion other than 0: the joint's axis follows "
        "from it",
        field, q.x, q.y, q.z, q.w));
  }
  void limits(const char* field, const Limits& l) const {
    if (std::isnan(l.low) || std::isnan(l.high) || l.low > l.high || l.low == unlimited ||
        l.high == -unlimited)
      fail(
          fmt::format("limits of {} are {:g} to {:g}; expected the lower limit first", field, l.low, l.high));
    at_least_0("compliance of a limit", l.compliance), at_least_0("damping of a limit", l.damping);
  }
  void motor(const Motor& m) const {
    finite("target of a motor", m.target);
    at_least_0("max_force of a motor", m.max_force, true);
    at_least_0("compliance of a motor", m.compliance), at_least_0("damping of a motor", m.damping);
  }
  void axis(const char* field, const Axis& a) const {
    limits(field, a.limits);
    if (a.spring) {
      finite("rest position of a spring", a.spring->rest);
      at_least_0("compliance of a spring", a.spring->compliance, true);
      at_least_0("damping of a spring", a.spring->damping);
      if (a.spring->compliance == unlimited && a.spring->damping == 0)
        fail("a spring of infinite compliance without damping does nothing; leave it out");
    }
    if (a.motor) motor(*a.motor);
  }
  template <class Kind>
  void stiffness(const Kind& k) const {
    at_least_0("compliance", k.compliance), at_least_0("damping", k.damping);
    if constexpr (requires { k.angular_compliance; }) {
      at_least_0("angular_compliance", k.angular_compliance);
      at_least_0("angular_damping", k.angular_damping);
    }
  }
};

void check_kind(const Check& check, const Fixed& k) {
  check.stiffness(k);
}

void check_kind(const Check& check, const Ball& k) {
  check.stiffness(k);
  if (!(k.max_swing == unlimited || (k.max_swing >= 0 && k.max_swing <= pi)))
    check.fail(fmt::format("max_swing is {:g} rad; expected an angle from 0 to pi, or infinity for none",
                           k.max_swing));
  check.at_least_0("swing_compliance", k.swing_compliance);
  check.limits("the twist", k.twist);
  for (const double angle : {k.twist.low, k.twist.high})
    if (std::isfinite(angle) && std::abs(angle) > pi)
      check.fail(fmt::format("a limit of the twist is {:g} rad; expected an angle from -pi to pi", angle));
  if (!k.spring) return;
  check.rotation("target of the spring", k.spring->target);
  check.at_least_0("compliance of the spring", k.spring->compliance);
  check.at_least_0("damping of the spring", k.spring->damping);
  check.at_least_0("max_torque of the spring", k.spring->max_torque, true);
}

void check_kind(const Check& check, const Hinge& k) {
  check.stiffness(k), check.axis("the rotation", k.rotation);
}

void check_kind(const Check& check, const Slider& k) {
  check.stiffness(k), check.axis("the translation", k.translation);
}

void check_kind(const Check& check, const Universal& k) {
  check.stiffness(k), check.axis("the first axis", k.first), check.axis("the second axis", k.second);
}

void check_kind(const Check& check, const Distance& k) {
  check.stiffness(k);
  check.at_least_0("shortest length", k.shortest), check.at_least_0("longest length", k.longest, true);
  if (k.longest < k.shortest)
    check.fail(fmt::format("lengths are {:g} to {:g}; expected the shortest first", k.shortest, k.longest));
  if (k.motor) check.motor(*k.motor);
}

void check_kind(const Check& check, const Pulley& k) {
  check.stiffness(k);
  check.point("wheel_a", k.wheel_a), check.point("wheel_b", k.wheel_b);
  check.at_least_0("length", k.length);
  if (!(k.ratio > 0 && k.ratio <= 1e6))
    check.fail(fmt::format("ratio is {:g}; expected a number greater than 0, up to 1e6", k.ratio));
}

}  // namespace

void validate(const Joint& joint, std::size_t body_count) {
  const Check check{joint.name};
  for (const std::uint32_t body : {joint.a, joint.b})
    if (body != no_body && body >= body_count)
      check.fail(fmt::format("body {} does not exist; there are {}", body, body_count));
  if (joint.a == joint.b)
    check.fail(joint.a == no_body ? "joins the world to itself; name at least one body"
                                  : "joins a body to itself; name two different bodies");
  check.point("point of frame_a", joint.frame_a.point), check.point("point of frame_b", joint.frame_b.point);
  check.rotation("rotation of frame_a", joint.frame_a.rotation);
  check.rotation("rotation of frame_b", joint.frame_b.rotation);
  check.positive("breaking_force", joint.breaking_force);
  check.positive("breaking_torque", joint.breaking_torque);
  std::visit([&](const auto& kind) { check_kind(check, kind); }, joint.kind);
}

}  // namespace souple::joint
