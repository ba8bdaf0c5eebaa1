#pragma once

#include "souple/math/vec3.h"

namespace souple {

/// Four particles from where a substep begins, x, to where it wants to end, p [m], each on a straight line at
/// a constant speed. Relative to a point nearby.
struct Moving4 {
  Vec3d x[4], p[4];
};

/// How far the substep may go: the largest time of [0, 1] known to be safe. Up to it, the distance of
/// particle 0 to the triangle 1, 2, 3 never falls below
///   gap [m] (or a 1024th of the distance at the begin, if that is more) where it begins above gap,
///   a tenth of the distance at the begin elsewhere;
/// so the two never touch, all rounding included. 1 if that holds for the whole motion.
///
/// Where the distance comes within 1/64 of its bound the answer may stop; a gap just below the distance at
/// the begin so stops at once what approaches. A straight approach is answered within 1/500 of the first
/// touch (gap 0). Where parts turn by more than their size about each other, one answer in some thousands
/// stops earlier: still safe.
///
/// A motion that begins in touch (to rounding, 64 eps of the particles' reach) gets 1 if every corner parts
/// along the normal, else 0. Coordinates that are not finite get 0.
double vertex_triangle_time(const Moving4& motion, double gap);

/// The same of the edges 0, 1 and 2, 3.
double edge_edge_time(const Moving4& motion, double gap);

}  // namespace souple
