#pragma once

#include "souple/fluid/fluid_walls.h"
#include "souple/fluid/foam_bodies.h"

#include <cstdint>
#include <span>
#include <vector>

namespace souple {

struct BoundaryMesh;
struct FluidInput;
struct FoamInput;
struct FluidState;

/// Collision of foam with the colliders and bodies that collide with any fluid.
class FoamCollisions {
 public:
  /// Finds the walls and bodies; they move straight from their positions at the start of the step to those at
  /// its end. `gap`: distance from them [m].
  void begin_step(const FluidInput& input, const FoamInput& foam, const FluidState& fluids, float gap);
  /// Moves particles whose path enters a wall or a body in front of it. A particle that a wall pushes moves away from
  /// the wall at least at its mean velocity of this step of dt seconds.
  void keep_out(std::span<const Vec3f> start, std::span<Vec3f> x, std::span<Vec3f> v, float dt,
                Threads& threads);
  void reserve(std::size_t count) { unconstrained_.reserve(count); }
  std::size_t bytes() const;

 private:
  void find_walls(const FluidInput& input, double dt, const FluidState& fluids);
  void find_bodies(const FluidInput& input, const FoamInput& foam, const FluidState& fluids);
  void add_body(const FluidInput& input, const FoamInput& foam, const BoundaryMesh& mesh,
                const Vec3d& origin);

  float gap_ = 0;
  // Per collider, and per boundary mesh: whether it collides with any fluid.
  std::vector<std::uint8_t> collides_with_collider_, collides_with_body_;
  FluidWalls walls_;
  FoamBodies bodies_;
  std::vector<Vec3f> start_, end_;    // vertices of a boundary mesh, relative to the origin [m]
  std::vector<Vec3f> unconstrained_;  // positions without collision
};

}  // namespace souple
