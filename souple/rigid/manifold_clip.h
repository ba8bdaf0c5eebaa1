#pragma once

#include "souple/rigid/manifold_points.h"

namespace souple::manifold {

/// The face of one shape against which the other, the incident shape, is clipped.
struct ReferenceFace {
  const ConvexView* shape;
  std::uint32_t face;
  bool is_of_a;
};

/// The part of the incident shape's opposing face (or segment, or point) within the sides of the reference face, in the
/// reference shape's frame. Only points with a height below `limit` [m] count. Sutherland and Hodgman, "Reentrant
/// Polygon Clipping", 1974. A vertex that lies outside a side by less than `slack` [m] remains. So noise does not
/// change the features of equal boxes on each other.
void clip_against(const ReferenceFace& reference, const ConvexView& incident,
                  const FrameChange& incident_to_reference, double slack, double limit,
                  ContactPoints& points);

}  // namespace souple::manifold
