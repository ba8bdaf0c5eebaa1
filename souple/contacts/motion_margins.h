#pragma once

#include "souple/collision/rigid_pose.h"
#include "souple/collision/shapes.h"
#include "souple/contacts/kernels/collider_contacts.h"
#include "souple/solver/projector.h"
#include "souple/threads/threads.h"

#include <array>
#include <cstdint>
#include <span>
#include <vector>

// How far particles and colliders may move before a search for pairs of them must be repeated.

namespace souple {

/// Particles of a search, where they were in it, and how far each may move until the next one.
class MotionMargins {
 public:
  /// Motion of particles as a search knows it.
  struct Speeds {
    std::span<const Vec4f> velocity;  ///< at a step's start [m/s]
    float h = 0;        ///< > 0: in the middle of a step; speeds are those of the predicted motion [s]
    float dt = 0;       ///< of the step [s]
    float gravity = 0;  ///< m/s^2
  };
  /// Margin of particle i: its radius plus twice its path in a step at its present speed and under gravity. Forces and
  /// neighbors change speeds, and a particle that leaves its margin costs a new search.
  void begin(std::span<const std::uint32_t> particle, std::span<const float> radius, const Speeds& speeds,
             const ParticleView& particles, Threads& threads);
  /// Whether one of them has left its margin. `particle`: those of the search.
  bool any_left(std::span<const std::uint32_t> particle, const kernels::ColliderContactKernels& kernels,
                const ParticleView& particles, Threads& threads) const;
  float operator[](std::size_t k) const { return margin_[k]; }
  float largest() const;
  std::size_t bytes() const;

 private:
  std::array<std::vector<float>, 3> at_;  // [m]
  std::vector<float> margin_;             // [m]
};

/// A moving collider since a search: how far it may go until the next one. Let the center move from c to c' and the
/// body turn by the angle a. Then a point at most R from the center moves by at most |c' - c| + a R.
class ColliderMargin {
 public:
  /// `ball`: around the shape, in its own frame. The search compares points of a distance of at most `near`
  /// plus three margins from the shape. `substeps`: until the next step.
  void begin(const BoundingBall& ball, double near, const RigidPose& before, const RigidPose& after,
             double substeps);
  /// No search has been made: the next substep makes one.
  void forget() { margin_ = -1; }
  /// Whether the collider leaves its margin in the substep from `before` to `after`.
  bool left(const RigidPose& before, const RigidPose& after) const;
  /// Motion that the search covers [m]; infinite: any motion.
  float margin() const { return static_cast<float>(margin_); }

 private:
  double motion(const RigidPose& from, const RigidPose& to) const;

  Vec3d center_{};
  double radius_ = 0, margin_ = -1;
  RigidPose searched_{};
};

}  // namespace souple
