#pragma once

#include "souple/math/vec3.h"

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace souple {

/// Tangent plane of a triangle mesh near a point: the mesh's surface as a fluid particle there feels it.
struct SurfacePlane {
  std::uint32_t triangle = 0;
  Vec3f normal{};      ///< unit vector toward the fluid
  Vec3f weights{};     ///< barycentric weights of `foot`
  Vec3f foot{};        ///< point of the triangle on the plane, relative to the particle [m]
  float distance = 0;  ///< of the particle in front of the plane [m]
  float share = 1;     ///< part of the half-space behind the plane that other planes do not represent
};

/// Approximates a triangle mesh near a particle by a few planes. The sum of their half-spaces is independent of the
/// triangulation and changes smoothly as the particle moves.
///
/// A convex part of the surface is one plane, through its nearest point. In a concave part each face is a
/// plane of its own. Faces that meet at 90 degrees count fully; faces that are almost parallel share one
/// half-space between them.
class SurfacePlanes {
 public:
  static constexpr std::size_t max_planes = 8;

  /// Starts a new point. Triangles further than `reach` [m] have no effect; faces blend over 0.6 times
  /// `search_radius` [m] on each side of a fold. Pressure ends a sixth of `search_radius` before `reach`.
  void begin(float reach, float search_radius) {
    reach_ = reach;
    influence_ = reach - search_radius / 6;
    blend_width_ = 0.6f * search_radius;
    triangles_.clear();
    count_ = 0;
  }
  float reach() const { return reach_; }
  /// Adds a triangle within reach whose nearest point to the particle has the given barycentric weights. Corners and
  /// `foot`, the nearest point, are relative to the particle [m]; `normal` is the unit normal toward the fluid.
  void add(std::uint32_t triangle, const std::array<Vec3f, 3>& corners, const Vec3f& weights,
           const Vec3f& foot, const Vec3f& normal);
  /// The planes of all triangles added, the nearest first.
  std::span<const SurfacePlane> select();

 private:
  struct Near {
    SurfacePlane plane;  // through the nearest point, its normal toward the particle
    std::array<Vec3f, 3> corners;
    Vec3f face;           // the triangle's normal
    bool inside = false;  // the nearest point is not on an edge
    bool open = true;     // neither selected nor without effect
    float visible = 1;    // how far the nearest point rises above the selected planes, in their distances
  };

  Near* nearest();
  Near* next();
  void hide_behind(const SurfacePlane& selected);
  float beyond_fold(const SurfacePlane& plane, const SurfacePlane& selected) const;
  float weight(std::size_t k) const;
  void find_shares();

  float reach_ = 0, influence_ = 0, blend_width_ = 0;  // m
  std::vector<Near> triangles_;
  std::array<SurfacePlane, max_planes> planes_{};
  std::size_t count_ = 0;
};

}  // namespace souple
