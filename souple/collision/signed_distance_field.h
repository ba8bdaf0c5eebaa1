#pragma once

#include "souple/collision/surface_distance.h"
#include "souple/geometry/triangle_mesh.h"

#include <cstddef>
#include <memory>
#include <vector>

namespace souple {

/// The solid inside a closed mesh, as a grid of its signed distances: what is as cheap to touch as a sphere,
/// however many triangles it has. Cheap to copy: copies share the grid, which never changes.
///
/// Distances are exact at the grid's points and trilinear between them, so a surface of curvature k is met to
/// about k spacing^2 / 4, and sharp edges are rounded by about a third of the spacing. Walls and gaps thinner
/// than two spacings are lost. The gradient is that of the interpolant.
///
/// The grid is cut into blocks of 8 x 8 x 8 cells. Those within 8 spacings of the surface hold all their
/// points; of the others, and of what is further from the mesh's box, little more than the corners is known:
/// at a distance d the error may reach 16 spacing^2 / d and a hundredth of d, and where several parts of the
/// surface are as far away the distance is too small by up to 4 spacings.
class SignedDistanceField {
 public:
  /// No solid: not to be used before another is assigned to it.
  SignedDistanceField() = default;
  /// The mesh in meters, in the collider's frame. What `repair` of mesh_report.h mends is mended first; solid
  /// is what the mesh goes around more than half a time (generalized winding number), so pieces may overlap
  /// and hold cavities. Takes about a microsecond and a half per point of the grid. Throws Error if the mesh
  /// is not closed, saying where it is open; if `spacing` is not positive; if the field would need more than
  /// `max_bytes`, with the spacing that would do.
  SignedDistanceField(const TriangleMesh& mesh, double spacing);

  static constexpr double max_bytes = 512.0 * 1024 * 1024;
  /// Distances of up to so many spacings are exact at the grid's points.
  static constexpr int fine_cells = 8;

  /// The spacing that cuts the longest side of the mesh into `resolution` cells [m].
  static double spacing_of(const TriangleMesh& mesh, int resolution);

  bool empty() const { return !grid_; }
  double spacing() const;
  /// The corners of the mesh's bounding box [m].
  Vec3d lo() const;
  Vec3d hi() const;
  /// The mesh as it was mended (welded, wound outward), to look at.
  const std::vector<Vec3d>& positions() const;
  const std::vector<Triangle>& triangles() const;
  /// What the grid and the mesh take, once for all copies.
  std::size_t bytes() const;

  /// Signed distance and outward normal at a point of the collider's frame.
  SurfaceDistance at(const Vec3d& point) const;

  /// How far along the unit direction d a ray from a point outside first meets the surface; infinity where it
  /// does not.
  double ray(const Vec3d& origin, const Vec3d& d) const;

  /// The same grid, not equal numbers.
  friend bool operator==(const SignedDistanceField& a, const SignedDistanceField& b) {
    return a.grid_ == b.grid_;
  }

 private:
  struct Grid;
  struct Builder;
  std::shared_ptr<const Grid> grid_;
};

}  // namespace souple
