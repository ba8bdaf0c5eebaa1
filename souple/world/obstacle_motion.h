#pragma once

#include "souple/collision/collider_motion.h"
#include "souple/math/vec3.h"

#include <vector>

namespace souple {

/// A mesh that deforms: all of its vertices at some moments. Between two they go straight, before the first
/// and after the last they stand still.
struct MeshSequence {
  /// User order, in the coordinates of the mesh that is added (its transform applies). [m]
  std::vector<std::vector<Vec3f>> frames{};
  double frame_rate = 60;  ///< frames a second
  /// Of each frame, since the first, ascending [s]; empty: frame / frame_rate.
  std::vector<double> times{};
  double start_time = 0;  ///< when the first frame plays [s]
  /// The time wraps round from the last frame to the first. Where these differ the mesh is somewhere else at
  /// once and has no velocity then.
  bool loop = false;
};

/// How an obstacle moves: x(t) = pose(t) (transform (mesh(t))). Static when both are left out.
struct ObstacleMotion {
  ColliderMotion pose{};    ///< turns and moves the mesh as it was placed, about the world's origin
  MeshSequence sequence{};  ///< instead of the mesh, when it has frames
};

}  // namespace souple
