#pragma once

#include "souple/collision/rigid_pose.h"
#include "souple/contacts/collider.h"
#include "souple/fluid/local_boundary.h"

#include <span>
#include <vector>

namespace souple {

/// Colliders near a fluid's particles, as boundary planes. Distances are computed in double precision in the
/// collider's own frame. A particle far from all static colliders skips them until its motion may have
/// brought it near one.
class FluidWalls {
 public:
  /// `origin` [m] is the origin of the fluid's positions. `collides[fluid * colliders + c]`: whether a fluid
  /// collides with a collider. The spans must live until the step ends.
  void begin_step(std::span<const Collider> colliders, std::span<const std::uint8_t> collides,
                  const Vec3d& origin, std::size_t particles, double time);
  /// Takes the poses at the end of the substep [time, time + h]. Throws if a collider's motion throws.
  void begin_substep(double time, double h);
  /// Corrected position of particle i, which was at `start` when the substep began and is predicted at x. It stays at
  /// least `radius` in front of each wall on its path. A particle that starts inside a wall is pushed out.
  Vec3f keep_out(std::size_t i, std::size_t fluid, const Vec3f& start, const Vec3f& x, float radius) const;
  /// keep_out for a particle that is not part of the fluid.
  Vec3f keep_out(std::size_t fluid, const Vec3f& start, const Vec3f& x, float radius) const;
  /// Appends the planes within `search_radius` of particle i of a fluid, at x. Threads may call it
  /// concurrently for different particles.
  void find(std::size_t i, std::size_t fluid, const Vec3f& x, float search_radius,
            std::vector<BoundaryPlane>& planes);

 private:
  struct Wall {
    std::uint32_t collider = 0;
    bool moves = false;
    RigidPose before, after;  // at the start and the end of the substep
    BoundingBall ball;
    Vec3d center{};  // of the ball, at the end of the substep
    // A static plane, relative to the origin of the fluid's positions: distance = normal . x - offset.
    bool is_plane = false;
    Vec3d normal{};
    double offset = 0;  // m
  };
  /// A position of a particle and its distance to the nearest static wall there.
  struct Clearance {
    Vec3f at{};
    float clear = -1;
  };

  bool collides_with(const Wall& wall, std::size_t fluid) const {
    return collides_[fluid * colliders_.size() + wall.collider] != 0;
  }
  Vec3f keep_out(std::size_t fluid, const Vec3f& start, const Vec3f& x, float radius, bool clear) const;
  /// Lower bound of the distance from x to a wall, cheaper than the distance itself.
  double distance_bound(const Wall& wall, const Vec3d& x) const {
    if (wall.is_plane) return dot(wall.normal, x) - wall.offset;
    return length(origin_ + x - wall.center) - wall.ball.radius;
  }
  Vec3d stopped_by(const Wall& wall, const Vec3d& start, const Vec3d& x, double radius) const;
  /// Appends the wall's plane if the wall is near; returns a lower bound of its distance.
  double add_plane(const Wall& wall, std::size_t fluid, const Vec3f& x, float search_radius,
                   std::vector<BoundaryPlane>& planes) const;

  std::span<const Collider> colliders_;
  std::span<const std::uint8_t> collides_;
  Vec3d origin_{};
  std::vector<Wall> static_walls_, moving_walls_;
  std::vector<Clearance> clearances_;
};

}  // namespace souple
