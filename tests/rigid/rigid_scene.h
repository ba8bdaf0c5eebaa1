#pragma once

#include "souple/rigid/contact_finder.h"
#include "souple/rigid/contact_solver.h"
#include "tests/rigid/one_body.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <functional>
#include <memory>
#include <numbers>
#include <span>
#include <utility>
#include <vector>

namespace souple::test {

/// One material for all pairs.
struct OneMaterial final : RigidMaterials {
  float friction = 0.5f, restitution = 0;
  bool collide(std::uint32_t /*a*/, std::uint32_t /*b*/) const override { return true; }
  ContactMaterialPair at(std::uint32_t /*a*/, std::uint32_t /*b*/) const override {
    return {friction, friction, restitution, 0};
  }
};

/// Rigid bodies and their contacts, without a world: a frame is 1/60 s, of ten substeps.
class RigidScene {
 public:
  static constexpr double frame = 1.0 / 60, g = 9.81;
  static constexpr int substeps = 10;

  explicit RigidScene(int threads = 1)
      : threads_(make_threads(threads > 1 ? Threading::pool : Threading::serial, threads)) {}

  RigidBodies bodies;
  OneMaterial material;
  Vec3d gravity{0, -g, 0};
  /// If set, moves bodies after contacts were solved, which are then solved again.
  std::function<void(RigidBodies&)> between;

  /// Mass 0: forces do not move the body.
  std::uint32_t add(ConvexShape shape, double mass, const Vec3d& inertia, const Vec3d& position,
                    const Quatd& rotation = {}) {
    const auto i = static_cast<std::uint32_t>(bodies.size());
    bodies.resize(i + 1);
    if (mass > 0) bodies.mass[i] = {1 / mass, {1 / inertia.x, 1 / inertia.y, 1 / inertia.z}};
    bodies.pose[i] = bodies.start[i] = {position, rotation};
    bodies.inverse_inertia[i] = world_inverse_inertia(bodies.mass[i], rotation);
    shapes_.emplace_back().parts.push_back(std::move(shape));
    return i;
  }
  std::uint32_t box(const Vec3d& half, const Vec3d& position, const Quatd& rotation = {},
                    double density = 1000) {
    const double m = 8 * half.x * half.y * half.z * density;
    const Vec3d s{half.x * half.x, half.y * half.y, half.z * half.z};
    return add(convex_box(half), m, Vec3d{s.y + s.z, s.x + s.z, s.x + s.y} * (m / 3), position, rotation);
  }
  std::uint32_t static_box(const Vec3d& half, const Vec3d& position) {
    return add(convex_box(half), 0, {}, position);
  }
  std::uint32_t ball(double radius, const Vec3d& position, double density = 1000) {
    const double m = 4 * std::numbers::pi / 3 * radius * radius * radius * density;
    const double I = 0.4 * m * radius * radius;
    return add(convex_sphere(radius), m, {I, I, I}, position);
  }
  /// Along y.
  std::uint32_t cylinder(double radius, double half, const Vec3d& position, const Quatd& rotation = {}) {
    return add(convex_cylinder(radius, half), 1, round_inertia(radius, half), position, rotation);
  }
  /// Along y; the inertia is that of a cylinder of its whole length.
  std::uint32_t capsule(double radius, double half, const Vec3d& position, const Quatd& rotation = {}) {
    return add(convex_capsule(radius, half), 1, round_inertia(radius, half + radius), position, rotation);
  }
  std::uint32_t plane() {
    const auto i = static_cast<std::uint32_t>(bodies.size());
    bodies.resize(i + 1);
    colliders_.push_back(std::make_unique<Shape>(Plane{}));
    shapes_.emplace_back().collider = colliders_.back().get();
    return i;
  }

  void step() {
    const ActiveScope active(*threads_);
    constexpr double h = frame / substeps;
    const double strength = length(gravity);
    predicted_.resize(bodies.size());
    finder_.begin_step(bodies, shapes_, material, frame, 1.0 / substeps, strength, *threads_);
    solver_.prepare(finder_.contacts(), bodies);
    for (int s = 0; s < substeps; ++s) {
      if (s > 0) finder_.refresh(bodies, shapes_, *threads_);
      const RigidSubstep substep{h, 1, 1.5, 2 * strength * h, gravity};
      solver_.bounce(finder_.contacts(), bodies, substep);
      predict_bodies(bodies, gravity, h, predicted_);
      solver_.solve(finder_.contacts(), bodies, substep, *threads_);
      if (between) {
        between(bodies);
        solver_.solve(finder_.contacts(), bodies, substep, *threads_);
      }
      finish_bodies(bodies, predicted_, h);
    }
  }
  void run(double seconds) {
    for (int f = 0; f < static_cast<int>(std::lround(seconds / frame)); ++f) step();
  }

  std::span<const RigidContact> contacts() const { return finder_.contacts(); }
  /// The deepest overlap that contacts know of [m].
  double deepest() const { return ContactSolver::deepest(finder_.contacts(), bodies); }
  bool moves(std::size_t i) const { return bodies.mass[i].inverse > 0; }
  double mass(std::size_t i) const { return moves(i) ? 1 / bodies.mass[i].inverse : 0; }
  double kinetic_energy() const {
    double sum = 0;
    for (std::size_t i = 0; i < bodies.size(); ++i)
      if (moves(i)) sum += 0.5 * mass(i) * length_squared(bodies.velocity[i].linear) + spin_energy(bodies, i);
    return sum;
  }
  double energy() const {
    double sum = kinetic_energy();
    for (std::size_t i = 0; i < bodies.size(); ++i) sum -= mass(i) * dot(gravity, bodies.pose[i].position);
    return sum;
  }
  Vec3d momentum() const {
    Vec3d sum{};
    for (std::size_t i = 0; i < bodies.size(); ++i) sum += bodies.velocity[i].linear * mass(i);
    return sum;
  }
  /// About the origin.
  Vec3d angular_momentum() const {
    Vec3d sum{};
    for (std::size_t i = 0; i < bodies.size(); ++i)
      if (moves(i))
        sum += cross(bodies.pose[i].position, bodies.velocity[i].linear) * mass(i) + spin_momentum(bodies, i);
    return sum;
  }
  /// The largest speed of a center of mass [m/s].
  double fastest() const {
    double result = 0;
    for (const BodyVelocity& v : bodies.velocity) result = std::max(result, length(v.linear));
    return result;
  }
  bool finite() const {
    return std::all_of(bodies.pose.begin(), bodies.pose.end(), [](const BodyPose& p) {
      return std::isfinite(length_squared(p.position)) && std::isfinite(p.rotation.w);
    });
  }

 private:
  static Vec3d round_inertia(double radius, double half) {
    const double across = radius * radius / 4 + half * half / 3;
    return {across, radius * radius / 2, across};
  }

  std::unique_ptr<Threads> threads_;
  std::vector<RigidShape> shapes_;
  std::vector<std::unique_ptr<Shape>> colliders_;
  ContactFinder finder_;
  ContactSolver solver_;
  std::vector<BodyPose> predicted_;
};

/// The farthest that a body's center is from where it was [m].
inline double farthest(std::span<const BodyPose> before, std::span<const BodyPose> after) {
  double result = 0;
  for (std::size_t i = 0; i < before.size(); ++i)
    result = std::max(result, length(after[i].position - before[i].position));
  return result;
}

/// Every bit of every pose.
inline bool same_bits(const RigidBodies& a, const RigidBodies& b) {
  return a.size() == b.size() && std::memcmp(a.pose.data(), b.pose.data(), a.size() * sizeof(BodyPose)) == 0;
}

}  // namespace souple::test
