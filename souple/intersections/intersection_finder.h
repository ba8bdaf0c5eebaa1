#pragma once

#include "souple/broad_phase/contact_surface.h"
#include "souple/broad_phase/near_pairs.h"
#include "souple/broad_phase/spatial_hash.h"
#include "souple/broad_phase/surface_elements.h"
#include "souple/solver/projector.h"
#include "souple/threads/threads.h"

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace souple {

/// An edge that passes through a triangle, of two objects or of one. They intersect where sum_k c_k x_k = 0.
/// So opposite forces on the two, distributed by c_k, conserve momentum and angular momentum.
struct EdgeIntersection {
  std::uint32_t edge = 0, triangle = 0;         ///< indices in SurfaceElements
  std::uint32_t edge_surface = 0, surface = 0;  ///< indices of the surfaces of the edge and of the triangle
  std::array<std::uint32_t, 5> particle{};      ///< ends of the edge, then corners of the triangle
  std::array<float, 5> c{};                     ///< weights of the ends; negative weights of the corners
};

/// Intersections of a ray with a surface.
struct SurfaceHit {
  int count = 0;                                     ///< number of intersections
  std::uint32_t triangle = SurfaceElement::no_edge;  ///< the first along the ray
  std::array<float, 3> weight{};                     ///< barycentric coordinates of the first intersection
};

/// Finds intersections: edges that pass through triangles. It ignores surfaces that do not collide, elements
/// that share a particle, and joined pairs. An edge that only touches a triangle, or lies in its plane,
/// does not intersect it.
class IntersectionFinder {
 public:
  IntersectionFinder() = default;
  /// The spans of `surfaces` may end before the finder.
  explicit IntersectionFinder(std::span<const ContactSurface> surfaces, ParticlePairs joined = {});

  /// Searches at the current positions. The result is sorted by edge, then triangle, and does not depend on
  /// the number of threads. Repeated calls allocate nothing.
  void find(const ParticleView& particles, Threads& threads);
  /// Searches only the pairs of surfaces that `enabled` contains; all of them must be able to collide.
  void find(const ParticleView& particles, const ObjectFilter& enabled, Threads& threads);
  std::span<const EdgeIntersection> intersections() const { return found_; }

  // Queries for IntersectionResolver and Layers, at the positions of the last `find`.

  const SurfaceElements& elements() const { return elements_; }
  std::size_t surface_count() const { return closed_.size(); }
  /// Whether a surface is watertight and all its triangles face outward, so that it has an inside.
  bool is_closed(std::size_t surface) const { return closed_[surface] != 0; }
  const Bounds& bounds(std::size_t surface) const { return surface_bounds_[surface]; }
  /// Corners opposite to an edge in up to two triangles; no_edge if there is none.
  const std::array<std::uint32_t, 2>& opposite(std::size_t edge) const { return opposite_[edge]; }
  /// Whether any pair of surfaces can collide.
  bool any_pair() const { return any_pair_; }
  /// Whether two particles are joined.
  bool are_joined(std::uint32_t i, std::uint32_t j) const { return joined_.contains(i, j); }
  std::uint32_t surface_of(std::size_t particle) const { return surface_of_[particle]; }

  /// Casts a ray from x_i + shift along a unit vector, to the end of the surface. The direction is accurate
  /// to 1e-3. `side`, 1 or -1: direction of a perturbation of x_i by about 1e-6 of the smaller object, in
  /// case x_i lies on the surface.
  SurfaceHit cast_ray(const ParticleView& particles, std::uint32_t i, const Vec3f& shift,
                      const Vec3f& direction, std::uint32_t surface, float side) const;
  /// Whether the edge, displaced by `shift`, would pass through a triangle of `surface` that overlaps
  /// `region`.
  bool would_intersect(const ParticleView& particles, std::uint32_t edge, const Vec3f& shift,
                       std::uint32_t surface, const Bounds& region) const;
  std::size_t bytes() const;

 private:
  struct Chunk {
    std::vector<EdgeIntersection> edges;
    std::vector<std::uint32_t> near;              // triangles near an edge
    std::vector<std::uint32_t> crossed_opposite;  // surfaces that it crosses when perturbed oppositely
  };

  void find_closed(std::span<const ContactSurface> surfaces);
  void find_opposite();
  void find_active(const ParticleView& particles, const ObjectFilter& enabled);
  bool may_intersect(const Bounds& box, std::uint32_t surface, const ObjectFilter& enabled) const;
  void find_boxes(const ParticleView& particles, Threads& threads);
  void find_chunk(const ParticleView& particles, const ObjectFilter& enabled, std::size_t chunk);
  bool is_joined(const EdgeIntersection& pair) const;
  Vec3f perturbation(std::uint32_t edge_surface, std::uint32_t surface) const;
  Bounds box_of(const ParticleView& particles, const Edge& edge, std::uint32_t edge_surface) const;

  SurfaceElements elements_;
  std::vector<ContactSurface> surfaces_;
  bool any_pair_ = false;
  ParticlePairs joined_;
  std::vector<std::array<std::uint32_t, 2>> ranges_;    // per surface: first and end particle
  std::vector<SpatialHash::Skip> own_triangles_;        // per surface
  std::vector<std::uint32_t> surface_of_;               // per particle
  std::vector<std::array<std::uint32_t, 2>> opposite_;  // per edge: see opposite()
  std::vector<std::uint8_t> closed_, active_;           // per surface
  std::vector<Bounds> surface_bounds_, widened_;        // per surface; with a margin for perturbations
  BoxSweep sweep_;
  std::vector<std::array<std::uint32_t, 2>>
      partners_;               // enabled pairs with overlapping bounds, in both orders, sorted
  std::vector<Bounds> boxes_;  // per triangle
  SpatialHash hash_;
  float cell_size_ = 1;  // m
  std::vector<Chunk> chunks_;
  std::vector<EdgeIntersection> found_;
};

}  // namespace souple
