#pragma once

#include "souple/collision/surface_distance.h"
#include "souple/geometry/triangle_mesh.h"

#include <cstddef>
#include <memory>
#include <string>
#include <vector>

namespace souple {

/// The solid inside a closed mesh, as a grid of signed distances. A query costs about as much as for a
/// sphere, whatever the number of triangles. Cheap to copy: copies share the grid, which never changes.
///
/// Distances are exact at the grid's points and trilinear between them. So the error at a surface of
/// curvature k is about k spacing^2 / 4, and sharp edges are rounded by about a third of the spacing. Walls
/// and gaps thinner than two spacings are lost. The gradient is that of the interpolant.
///
/// The grid is divided into blocks of 8 x 8 x 8 cells. Blocks within 8 spacings of the surface store all
/// their points, other blocks only their corners. There, and outside the grid, the error at a distance d may
/// reach 16 spacing^2 / d and a hundredth of d. Where several parts of the surface are equally far, the
/// distance is too small by up to 4 spacings.
class SignedDistanceField {
 public:
  /// An empty field: assign another field before any use.
  SignedDistanceField() = default;
  /// `mesh`: in the collider's frame [m]. It is first repaired, and its small holes are closed (close_holes.h). Points
  /// are solid where the generalized winding number is above one half, so pieces may overlap and have cavities. Costs
  /// about 1.5 microseconds per point of the grid. Throws Error in four cases. The mesh has more than `max_triangles`. It
  /// has large holes: the message locates them. `spacing` is not positive. The field would need more than
  /// `max_bytes`: the message gives a spacing that fits.
  SignedDistanceField(const TriangleMesh& mesh, double spacing);

  static constexpr double max_bytes = 512.0 * 1024 * 1024;
  static constexpr std::size_t max_triangles = 500000;
  /// Distances of up to this many spacings are exact at the grid's points.
  static constexpr int fine_cells = 8;

  /// The spacing that divides the mesh's longest side into `resolution` cells [m].
  static double spacing_of(const TriangleMesh& mesh, int resolution);

  bool empty() const { return !grid_; }
  double spacing() const;
  /// Corners of the mesh's bounding box [m].
  Vec3d lo() const;
  Vec3d hi() const;
  /// The repaired mesh (welded, wound outward, closed), for drawing.
  const std::vector<Vec3d>& positions() const;
  const std::vector<Triangle>& triangles() const;
  /// Which holes of the mesh were closed, for the log.
  const std::vector<std::string>& sentences() const;
  /// Memory of the grid and the mesh, which all copies share.
  std::size_t bytes() const;

  /// Signed distance and outward normal at a point in the collider's frame.
  SurfaceDistance at(const Vec3d& point) const;

  /// Distance along the unit direction d at which a ray from a point outside first hits the surface [m];
  /// infinity where it does not.
  double ray(const Vec3d& origin, const Vec3d& d) const;

  struct Grid;
  /// See signed_distance_grid.h. The field must not be empty.
  const Grid& grid() const { return *grid_; }

  /// True for copies that share one grid; equal numbers in two grids do not count.
  friend bool operator==(const SignedDistanceField& a, const SignedDistanceField& b) {
    return a.grid_ == b.grid_;
  }

 private:
  struct Builder;
  std::shared_ptr<const Grid> grid_;
};

}  // namespace souple
