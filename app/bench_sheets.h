#pragma once

#include "souple/collision/near_pairs.h"

#include <vector>

// The scene of `souple bench triangles`, for that benchmark and for the peers.

namespace souple::app {

/// Crumpled sheets in motion: folded in layers that nearly touch, each turning and moving its own way,
/// rippled, packed as close as their size allows. Edges are 2 cm long, thickness is 4 mm.
class Sheets {
 public:
  static constexpr double thickness = 0.004;  ///< m
  static constexpr double dt = 1.0 / 60;      ///< s, of a step

  /// About so many triangles, in sheets of 4802 or less.
  explicit Sheets(int triangles);

  /// Where everything is after so many steps, and its boxes: swept over the next step and thickened.
  void move_to(int step);

  const SurfaceElements& elements() const { return elements_; }
  std::span<const Bounds> boxes() const { return boxes_; }
  /// w = inverse mass.
  std::span<const Vec4f> positions() const { return positions_; }
  /// All sheets collide with each other and with themselves.
  const ObjectMatrix& matrix() const { return matrix_; }
  std::size_t sheets() const { return matrix_.size(); }
  /// Vertices of each sheet: sheet s has particles [s n, (s + 1) n).
  std::size_t vertices_of_sheet() const { return flat_.size(); }
  const std::vector<Triangle>& triangles_of_sheet() const { return triangles_; }
  /// Each particle's motion within the step. [m]
  std::span<const Vec3f> motion() const { return motion_; }

 private:
  Vec3d position(std::size_t sheet, const Vec3d& flat, double time) const;

  std::vector<Vec3d> flat_;  // of each vertex of a sheet
  std::vector<Triangle> triangles_;
  SurfaceElements elements_;
  ObjectMatrix matrix_;
  std::vector<Vec4f> positions_;
  std::vector<Vec3f> motion_;
  std::vector<Bounds> boxes_;
};

}  // namespace souple::app
