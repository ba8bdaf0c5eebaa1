#pragma once

#include "souple/collision/collider.h"
#include "souple/collision/rigid_pose.h"
#include "souple/fluid/local_boundary.h"

#include <span>
#include <vector>

namespace souple {

/// The colliders near a fluid's particles, as planes. Distances are computed in double, in the collider's own
/// frame; a particle far from all that stand still is not clearance at again before it may have come near one.
class FluidWalls {
 public:
  /// `origin` [m] is that of the fluid's positions. `collides[fluid * colliders + c]`: whether a fluid feels a
  /// collider. What is passed lives until the step ends.
  void begin_step(std::span<const Collider> colliders, std::span<const std::uint8_t> collides,
                  const Vec3d& origin, std::size_t particles, double time);
  /// Poses at the end of the substep [time, time + h]. Throws what a collider's motion throws.
  void begin_substep(double time, double h);
  /// Where particle i comes that was at `start` when the substep began and is predicted at x: before the
  /// walls it would have gone into or through, at least `radius` away. What is inside a wall already comes
  /// out.
  Vec3f keep_out(std::size_t i, std::size_t fluid, const Vec3f& start, const Vec3f& x, float radius) const;
  /// The same for what is no particle of the fluid.
  Vec3f keep_out(std::size_t fluid, const Vec3f& start, const Vec3f& x, float radius) const;
  /// Appends the planes nearer than `search_radius` to particle i of a fluid, at x. For different particles, several
  /// threads may call it at a time.
  void find(std::size_t i, std::size_t fluid, const Vec3f& x, float search_radius,
            std::vector<BoundaryPlane>& planes);

 private:
  struct Wall {
    std::uint32_t collider = 0;
    bool moves = false;
    RigidPose before, after;  // at the substep's begin and end
    BoundingBall ball;
    Vec3d center{};  // of the ball, at the substep's end
    // A plane that stands still, from the origin of the fluid's positions: distance = normal . x - offset.
    bool is_plane = false;
    Vec3d normal{};
    double offset = 0;  // m
  };
  /// Where a particle was clearance at, and how far all walls that stand still were then.
  struct Clearance {
    Vec3f at{};
    float clear = -1;
  };

  bool collides_with(const Wall& wall, std::size_t fluid) const {
    return collides_[fluid * colliders_.size() + wall.collider] != 0;
  }
  Vec3f keep_out(std::size_t fluid, const Vec3f& start, const Vec3f& x, float radius, bool clear) const;
  /// How far a wall is from x, or less: without the rest of what a shape's distance takes.
  double distance_bound(const Wall& wall, const Vec3d& x) const {
    if (wall.is_plane) return dot(wall.normal, x) - wall.offset;
    return length(origin_ + x - wall.center) - wall.ball.radius;
  }
  Vec3d stopped_by(const Wall& wall, const Vec3d& start, const Vec3d& x, double radius) const;
  /// Appends the plane if it is near; how far the wall is, or less.
  double add_plane(const Wall& wall, std::size_t fluid, const Vec3f& x, float search_radius,
                   std::vector<BoundaryPlane>& planes) const;

  std::span<const Collider> colliders_;
  std::span<const std::uint8_t> collides_;
  Vec3d origin_{};
  std::vector<Wall> static_walls_, moving_walls_;
  std::vector<Clearance> clearances_;
};

}  // namespace souple
