#pragma once

#include "souple/math/vec3.h"

namespace souple {

/// Positions of four particles at the start of a substep, x, and at its predicted end, p [m]. Each moves on a
/// straight line at constant speed. Relative to a nearby point.
struct Moving4 {
  Vec3d x[4], p[4];
};

/// A conservative time of impact: the largest time in [0, 1] known to be safe. Up to it, the distance of
/// particle 0 to triangle 1, 2, 3 never falls below
///   gap [m] (or a 1024th of the initial distance, if that is more) if the initial distance exceeds gap,
///   a tenth of the initial distance otherwise;
/// so the two never touch, all rounding included. 1 if that holds for the whole motion.
///
/// The result may be earlier when the distance comes within 1/64 of its bound. So with a gap just below the
/// initial distance, approaching elements get time 0. For a straight approach the result is within 1/500 of
/// the first contact (gap 0). If elements rotate by more than their size about each other, one result in some
/// thousands is earlier: still safe.
///
/// A motion that starts in contact gets 1 if every corner separates along the normal, else 0. Contact is to rounding,
/// 64 eps of the extent of the particles. Coordinates that are not finite get 0.
double vertex_triangle_time(const Moving4& motion, double gap);

/// Likewise for edges 0, 1 and 2, 3.
double edge_edge_time(const Moving4& motion, double gap);

}  // namespace souple
