#pragma once

#include "souple/fluid/foam.h"
#include "souple/fluid/stage/foam_collisions.h"

#include <cstdint>
#include <span>
#include <vector>

namespace souple {

struct FluidReport;

/// Diffuse particles (spray, foam and bubbles) of a world's fluids. They store nothing about fluid particles
/// from one step to the next.
class FluidFoam {
 public:
  /// Spawns, moves and dissolves particles over a step that started at input.time. `view`: of the fluids at its
  /// end.
  void step(const FluidInput& input, const FoamInput& foam, FluidState& fluids, const FluidView& view);
  void clear();
  void report(FluidReport& report) const;

  std::size_t size() const { return positions_.size(); }
  std::span<const Vec3f> positions() const { return positions_; }           ///< in world space [m]
  std::span<const Vec3f> velocities() const { return foam_.velocities(); }  ///< m/s
  std::span<const FoamKind> kinds() const { return foam_.kinds(); }
  std::size_t bytes() const;

  /// For snapshots; positions are relative to the origin.
  const FoamState& state() const { return foam_.state(); }
  const Vec3d& origin() const { return origin_; }
  void set_state(FoamState state, const Vec3d& origin);

 private:
  void choose_shape(SmoothingShape shape, std::size_t max_particles);
  void set_origin(const Vec3d& origin);
  void read_fluids(FluidState& fluids, Threads& threads);
  void update_positions();

  SmoothingShape shape_ = SmoothingShape::wendland;
  Foam foam_;
  Vec3d origin_{};
  Foam::Report report_;
  FoamCollisions collisions_;
  // Data of the fluids' particles by sorted index.
  std::vector<std::uint32_t> particle_;  // index in the world
  std::vector<Vec3f> wall_slopes_;       // 1/m
  std::vector<float> share_;             // FluidMaterial::foam
  std::vector<Vec3f> positions_;
};

}  // namespace souple
