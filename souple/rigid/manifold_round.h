#pragma once

#include "souple/rigid/manifold.h"
#include "souple/rigid/manifold_view.h"

#include <array>

namespace souple::manifold {

/// A cylinder lies on its side if the sine of its axis' inclination to the surface is less than this.
inline constexpr double most_inclined = 0.02;

/// The normals of a prism and of its round side differ less: the product of the normals exceeds this. The axis must
/// also lie in the surface. Otherwise the nearest point may be on the round ends of the segment, which the cylinder
/// does not have.
inline constexpr double like_normals = 0.95;

/// The axis of a cylinder, as a segment with a radius.
struct RoundView {
  std::array<Vec3d, 2> vertices;
  std::array<ConvexEdge, 1> edges{{{.from = 0, .to = 1}}};
  ConvexView view;

  explicit RoundView(const RoundSide& side);
  RoundView(const RoundView&) = delete;
  RoundView& operator=(const RoundView&) = delete;
};

bool lies_on_side(const ConvexShape& shape, const BodyPose& pose, const Vec3d& normal);

/// Removes the points at `margin` or beyond, which only the wider search of a round side finds.
void drop_beyond(double margin, Manifold& found);

/// Replaces the contact points of prisms by those of the round sides of cylinders, if a or b lies on it.
void round_off(const ConvexShape& a, const BodyPose& pose_a, const ConvexShape& b, const BodyPose& pose_b,
               double margin, const PairMotion& local_motion, Manifold& found);

}  // namespace souple::manifold
