#pragma once

#include "souple/collision/collider_motion.h"
#include "souple/math/vec3.h"

#include <vector>

namespace souple {

/// A deforming mesh: all vertex positions at given times. Between frames they are interpolated linearly.
/// Before the first frame and after the last they are constant.
struct MeshSequence {
  /// Positions per frame in user order, in the coordinates of the added mesh (its transform applies) [m].
  std::vector<std::vector<Vec3f>> frames{};
  double frame_rate = 60;  ///< frames per second
  /// Time of each frame since the first, ascending [s]; empty: frame / frame_rate.
  std::vector<double> times{};
  double start_time = 0;  ///< time of the first frame [s]
  /// Time wraps from the last frame to the first. If these frames differ, the mesh jumps there and has no
  /// velocity then.
  bool loop = false;
};

/// Motion of an obstacle: x(t) = pose(t) (transform (mesh(t))). Static by default.
struct ObstacleMotion {
  ColliderMotion pose{};    ///< rotates and translates the placed mesh about the world's origin
  MeshSequence sequence{};  ///< replaces the mesh if it has frames
};

}  // namespace souple
