#pragma once

#include "souple/broad_phase/near_pairs.h"

#include <vector>

// The scene of `souple bench triangles`, also used by the comparison with other engines.

namespace souple::app {

/// Crumpled sheets in motion: folded in layers that nearly touch, rippled, and packed as densely as their
/// size allows. Each sheet rotates and moves independently. Edges are 2 cm long, thickness is 4 mm.
class Sheets {
 public:
  static constexpr double thickness = 0.004;  ///< m
  static constexpr double dt = 1.0 / 60;      ///< s, per step

  /// About this many triangles, in sheets of at most 4802.
  explicit Sheets(int triangles);

  /// Sets positions after `step` steps, and the bounding boxes: swept over the next step and grown by the
  /// thickness.
  void move_to(int step);

  const SurfaceElements& elements() const { return elements_; }
  std::span<const Bounds> boxes() const { return boxes_; }
  /// Per particle: position, w = inverse mass.
  std::span<const Vec4f> positions() const { return positions_; }
  std::size_t sheets() const { return positions_.size() / flat_.size(); }
  /// Vertices of each sheet: sheet s has particles [s n, (s + 1) n).
  std::size_t vertices_of_sheet() const { return flat_.size(); }
  const std::vector<Triangle>& triangles_of_sheet() const { return triangles_; }
  /// Per particle: motion within the step. [m]
  std::span<const Vec3f> motion() const { return motion_; }

 private:
  Vec3d position(std::size_t sheet, const Vec3d& flat, double time) const;

  std::vector<Vec3d> flat_;  // per vertex of a sheet
  std::vector<Triangle> triangles_;
  SurfaceElements elements_;
  std::vector<Vec4f> positions_;
  std::vector<Vec3f> motion_;
  std::vector<Bounds> boxes_;
};

}  // namespace souple::app
