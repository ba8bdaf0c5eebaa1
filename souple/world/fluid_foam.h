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

/// Spray, foam and bubbles of a world's fluids, and what they do not go through: the colliders and bodies
/// that some fluid meets. They remember nothing of the fluids' particles from one step to the next.
class FluidFoam {
 public:
  /// What it asks of the fluids at the end of a step, beside their FluidView.
  struct Source {
    // By place.
    std::vector<std::uint32_t> particle;  ///< the world's
    std::vector<Vec3f> wall_slopes;       ///< 1/m
    std::vector<float> share;             ///< FluidMaterial::foam
    // Of each collider and mesh: whether some fluid meets it.
    std::vector<std::uint8_t> collides_with_collider, collides_with_body;
    std::span<const BoundaryMesh> meshes;
    Vec3d origin;  ///< of the fluid's positions [m]
  };

  /// What a step of dt seconds that began at `time` makes, moves and dissolves.
  void step(WorldState& world, const FluidView& fluid, const Source& source, double time, double dt);
  void clear();
  void report(FluidReport& report) const;

  std::size_t size() const { return positions_.size(); }
  std::span<const Vec3f> positions() const { return positions_; }  ///< of the world [m]
  std::span<const Vec3f> velocities() const;                       ///< m/s
  std::span<const FoamKind> kinds() const;
  std::size_t bytes() const;

  /// For snapshots: positions are from the origin.
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
  std::vector<Vec3f> start_, end_;    // of a mesh's vertices, from the origin [m]
  std::vector<Vec3f> unconstrained_;  // where particles go if nothing stops them
  std::vector<Vec3f> positions_;
};

}  // namespace souple
