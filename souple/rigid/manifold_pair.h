#pragma once

#include "souple/rigid/manifold.h"
#include "souple/rigid/manifold_axes.h"
#include "souple/rigid/manifold_points.h"
#include "souple/rigid/manifold_view.h"

namespace souple::manifold {

/// Two shapes that may touch, with the parameters that decide about their contact points.
struct ShapePair {
  ConvexView a, b;
  FrameChange b_to_a, a_to_b;
  double margin = 0;          ///< m
  double axis_tolerance = 0;  ///< m; see souple::axis_tolerance
  double slack = 0;           ///< by which a contact point may lie beside a face [m]
  PairMotion motion{};        ///< in a's frame
  /// The normals that b permits, if it is a triangle; then both frames are the region's.
  const NormalRegion* region = nullptr;

  double rounding() const { return a.radius + b.radius; }
  /// Cores that are nearer than this give contact points [m].
  double limit() const { return margin + rounding(); }
};

/// A pair of shapes in the frame of a. `motion`: in the same frame.
ShapePair make_pair(const ConvexView& a, const ConvexView& b, const FrameChange& b_to_a, double margin,
                    const PairMotion& motion);

inline PairMotion local_motion(const BodyPose& pose, const PairMotion& motion) {
  return {pose.local_direction(motion.path), pose.local_direction(motion.turn)};
}

/// Contact points whose normal is in a's frame.
void find_points(const ShapePair& pair, AxisCache& cache, Manifold& manifold);

/// Contact points of two segments or points.
void find_segment_points(const ShapePair& pair, Manifold& manifold);

/// The segment of a core, or an edge, in a's frame.
struct Segment {
  Vec3d from, to;
  Vec3d along() const { return to - from; }
  Vec3d at(double s) const { return from + (to - from) * s; }
};

/// Adds two points if the segments lie beside each other and are parallel within 0.01 rad; false if they are not.
/// `axis`: unit, from a to b.
bool add_parallel_segments(const ShapePair& pair, const Segment& a, const Segment& b, const Vec3d& axis,
                           std::uint32_t feature, Manifold& manifold);

/// Adds one point. `core_a`, `core_b`: points of the two cores, `axis`: unit, from a to b, all in a's frame.
void add_point(const ShapePair& pair, const Vec3d& core_a, const Vec3d& core_b, const Vec3d& axis,
               std::uint32_t feature, Manifold& manifold);

}  // namespace souple::manifold
