#pragma once

#include "souple/rigid/manifold_points.h"

namespace souple::manifold {

/// The face of one shape against which the other, the incident shape, is clipped.
struct ReferenceFace {
  const ConvexView* shape;
  std::uint32_t face;
  bool is_of_a;
};

/// The part of the incident shape's opposing face (segment, point) above or below the reference face, within its sides, in the reference shape's frame; only points with a height below `limit` [m]. Sutherland and
/// Hodgman, "Reentrant Polygon Clipping", 1974. A vertex that lies outside a side by less than `slack` [m] remains:
/// so the features of equal boxes on each other do not depend on noise.
void clip_against(const ReferenceFace& reference, const ConvexView& incident,
                  const FrameChange& incident_to_reference, double slack, double limit,
                  ContactPoints& points);

}  // namespace souple::manifold
