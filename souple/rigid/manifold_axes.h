#pragma once

#include "souple/rigid/manifold_view.h"

namespace souple::manifold {

/// The normals that a triangle of a mesh permits, which do not lean too far over its edges.
struct NormalRegion {
  Vec3d normal{};      ///< of the triangle
  Vec3d outward[3]{};  ///< in the triangle's plane, over its edges
  double lean[3]{};    ///< see ContactTriangle

  /// `push`: unit, from the triangle to the shape.
  bool admits(const Vec3d& push) const {
    constexpr double rounding = 1e-6;
    return dot(push, normal) >= -rounding && dot(push, outward[0]) <= lean[0] + rounding &&
           dot(push, outward[1]) <= lean[1] + rounding && dot(push, outward[2]) <= lean[2] + rounding;
  }
};

/// Separation of two shapes' cores along the normal of a face of one of them.
struct FaceAxis {
  std::uint32_t face = no_face;
  double separation = 0;  ///< m; -infinity without a face
};

FaceAxis face_axis(const ConvexView& reference, const ConvexView& other,
                   const FrameChange& other_to_reference, std::uint32_t face);

/// The face with the largest separation, of those that exceed `floor`. With a region, both shapes' frames must be the
/// region's; a normal of the reference then pushes the other shape if `pushes_other`, else the reference.
FaceAxis best_face_axis(const ConvexView& reference, const ConvexView& other,
                        const FrameChange& other_to_reference, double floor,
                        const NormalRegion* region = nullptr, bool pushes_other = false);

/// Separation along the common perpendicular of an edge of a and an edge of b.
struct EdgeAxis {
  std::uint32_t a = no_face, b = no_face;  ///< no_face: none
  double separation = 0;                   ///< m
  Vec3d axis{};                            ///< unit, from a to b, in a's frame
};

/// A point of each core, in a's frame, that lies deep in the other or near to it: they bound the separation along other
/// axes.
struct DeepPoints {
  Vec3d of_a{}, of_b{};
  bool has_a = false, has_b = false;
};

/// The pair of edges with the largest separation, of those that exceed `floor`.
EdgeAxis best_edge_axis(const ConvexView& a, const ConvexView& b, const FrameChange& b_to_a, double floor,
                        const DeepPoints& deep, const NormalRegion* region = nullptr);

/// Separation along any unit axis from a to b, in a's frame. At most the distance of the two cores.
double separation_along(const ConvexView& a, const ConvexView& b, const FrameChange& b_to_a,
                        const Vec3d& axis);

}  // namespace souple::manifold
