#pragma once

#include "souple/broad_phase/near_pairs.h"
#include "souple/collision/segment_triangle/segment_triangle.h"
#include "souple/solver/projector.h"

namespace souple {

/// Crossing of a vertex' path and a triangle.
struct PathCrossing {
  bool found = false;
  Vec3f weight;  ///< barycentric coordinates of the crossing for the three corners
  Vec3f normal;  ///< unit normal of the triangle, to the side that the vertex comes from
};

/// Discrete detection of a vertex v and a triangle (Müller et al. 2007, section 3.4: "the ray x_i -> p_i enters an
/// object"). The vertex' path within the substep must cross the triangle of the substep's start.
///
///   path: x_v + t d,  0 <= t <= 1,   d = (p_v - x_v) - 1/3 sum_k (p_k - x_k)
///
/// Deviations: the path is relative to the triangle's mean motion, so that a moving triangle meets a vertex at
/// rest. If the path ends on the side of the triangle's plane where it begins, a segment longer by the thickness along
/// the normal also counts. So a vertex that rests on a triangle keeps its contact. Pairs whose particles cannot move do
/// not cross.
PathCrossing find_path_crossing(const CrossingTest& test, const NearPair& pair, float thickness,
                                const ParticleView& particles);

}  // namespace souple
