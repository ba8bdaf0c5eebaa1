#pragma once

#include "souple/fluid/fluid_bodies.h"
#include "souple/fluid/fluid_walls.h"
#include "souple/fluid/foam.h"
#include "souple/fluid/foam_bodies.h"
#include "souple/world/report.h"

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

namespace souple {

struct WorldState;

/// Diffuse particles (spray, foam and bubbles) of a world's fluids, and their collision with the colliders
/// and bodies that collide with a fluid. They store nothing about fluid particles from one step to the next.
class FluidFoam {
 public:
  /// Input from the fluids at the end of a step, in addition to their FluidView.
  struct Source {
    // By sorted index.
    std::vector<std::uint32_t> particle;  ///< index in the world
    std::vector<Vec3f> wall_slopes;       ///< 1/m
    std::vector<float> share;             ///< FluidMaterial::foam
    // Per collider, and per boundary mesh: whether it collides with any fluid.
    std::vector<std::uint8_t> collides_with_collider, collides_with_body;
    std::span<const BoundaryMesh> meshes;
    Vec3d origin;  ///< origin of the fluids' positions [m]
  };

  /// Spawns, moves and dissolves particles over a step of dt seconds that started at `time`.
  void step(WorldState& world, const FluidView& fluid, const Source& source, double time, double dt);
  void clear();
  void report(FluidReport& report) const;

  std::size_t size() const { return positions_.size(); }
  std::span<const Vec3f> positions() const { return positions_; }  ///< in world space [m]
  std::span<const Vec3f> velocities() const;                       ///< m/s
  std::span<const FoamKind> kinds() const;
  std::size_t bytes() const;

  /// For snapshots; positions are relative to the origin.
  const FoamState& state() const { return foam_->state(); }
  const Vec3d& origin() const { return origin_; }
  void set_state(FoamState state, const Vec3d& origin);

 private:
  void choose_shape(SmoothingShape shape, std::size_t max_particles);
  void find_bodies(const WorldState& world, const Source& source, float gap, Threads& threads);
  void keep_out(std::span<const Vec3f> start, std::span<Vec3f> x, std::span<Vec3f> v, float gap, float dt,
                Threads& threads);
  void update_positions();

  SmoothingShape shape_ = SmoothingShape::wendland;
  std::unique_ptr<Foam> foam_ = std::make_unique<Foam>();
  Vec3d origin_{};
  Foam::Report report_;
  FluidWalls walls_;
  FoamBodies bodies_;
  std::vector<Vec3f> start_, end_;    // vertices of a boundary mesh, relative to the origin [m]
  std::vector<Vec3f> unconstrained_;  // positions without collision
  std::vector<Vec3f> positions_;
};

}  // namespace souple
