#pragma once

#include "souple/rigid/joints/joint_solver.h"
#include "tests/rigid/one_body.h"

#include <algorithm>
#include <vector>

namespace souple {

/// Bodies and joints, stepped by one projection a substep of 1/600 s.
struct JointWorld {
  RigidBodies bodies{};
  joint::Joints joints{};
  joint::JointSolver solver{};
  Vec3d gravity{0, -9.81, 0};
  double h = 1.0 / 600;
  int iterations = 1;
  double time = 0;
  std::vector<BodyPose> predicted{};
  std::vector<Vec3d> force{}, torque{};  ///< on each body [N], [N m]
  joint::JointError worst{};             ///< of all joints so far

  std::uint32_t add_body(double mass, const Vec3d& inertia, const Vec3d& position) {
    const auto i = static_cast<std::uint32_t>(bodies.size());
    bodies.resize(i + 1);
    bodies.mass[i] = {1 / mass, {1 / inertia.x, 1 / inertia.y, 1 / inertia.z}};
    bodies.pose[i] = bodies.start[i] = {position, {}};
    bodies.inverse_inertia[i] = world_inverse_inertia(bodies.mass[i], {});
    predicted.resize(i + 1), force.resize(i + 1), torque.resize(i + 1);
    return i;
  }
  /// Adds a box of full edges [m].
  std::uint32_t add_box(double mass, const Vec3d& e, const Vec3d& position) {
    const double m = mass / 12;
    return add_body(mass,
                    {m * (e.y * e.y + e.z * e.z), m * (e.z * e.z + e.x * e.x), m * (e.x * e.x + e.y * e.y)},
                    position);
  }
  /// Between the bodies as they are placed now; its first axis is `axis`.
  std::uint32_t add_joint(const joint::Kind& kind, std::uint32_t a, std::uint32_t b, const Vec3d& point,
                          const Vec3d& axis = {1, 0, 0}) {
    joint::Joint joint{.name = "tested", .a = a, .b = b, .kind = kind};
    place(joint, bodies, point, joint::axes_along(axis));
    return add(joints, joint, bodies.size());
  }

  void step() {
    for (std::uint32_t i = 0; i < bodies.size(); ++i) {
      push_velocity(bodies, i, {}, force[i] * h);
      turn_velocity(bodies, i, torque[i] * h);
    }
    predict_bodies(bodies, gravity, h, predicted);
    solver.begin_substep(joints, bodies, h);
    for (int k = 0; k < iterations; ++k) solver.project(joints, bodies);
    solver.end_substep(joints);
    finish_bodies(bodies, predicted, h);
    time += h;
    for (std::size_t j = 0; j < joints.size(); ++j) {
      const joint::JointError e = error_of(joints.joint[j], joints.state[j], bodies);
      worst = {std::max(worst.distance, e.distance), std::max(worst.angle, e.angle)};
    }
  }
  template <class F>
  void run(double seconds, F&& after_step) {
    const auto steps = static_cast<long>(seconds / h + 0.5);
    for (long i = 0; i < steps; ++i) step(), after_step();
  }
  void run(double seconds) {
    run(seconds, [] {});
  }

  Vec3d momentum() const {
    Vec3d p;
    for (std::size_t i = 0; i < bodies.size(); ++i) p += bodies.velocity[i].linear / bodies.mass[i].inverse;
    return p;
  }
  /// About the origin.
  Vec3d angular_momentum() const {
    Vec3d L;
    for (std::size_t i = 0; i < bodies.size(); ++i)
      L += spin_momentum(bodies, i) +
           cross(bodies.pose[i].position, bodies.velocity[i].linear / bodies.mass[i].inverse);
    return L;
  }
  double energy() const {
    double E = 0;
    for (std::size_t i = 0; i < bodies.size(); ++i) {
      const double m = 1 / bodies.mass[i].inverse;
      const Vec3d& v = bodies.velocity[i].linear;
      E += m * dot(v, v) / 2 + dot(spin_momentum(bodies, i), bodies.velocity[i].angular) / 2 -
           m * dot(gravity, bodies.pose[i].position);
    }
    return E;
  }
};

/// Times at which a signal rises through zero, interpolated.
struct Crossings {
  double before = 0, time_before = 0;
  bool any = false;
  std::vector<double> times{};

  void see(double time, double value) {
    if (any && before < 0 && value >= 0)
      times.push_back(time - (time - time_before) * value / (value - before));
    before = value, time_before = time, any = true;
  }
  double period() const { return (times.back() - times.front()) / static_cast<double>(times.size() - 1); }
};

}  // namespace souple
