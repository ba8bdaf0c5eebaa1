#pragma once

#include "souple/intersections/intersection_finder.h"

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace souple {

/// A point of an upper surface that lies under a lower one. To resolve it, particles move outward along `direction`
/// with the weights c. The sum of c_k x_k is the point of the upper surface minus the point of the lower one.
struct LayerViolation {
  std::uint32_t vertex = 0, surface = 0;  ///< until resolved, contacts of this vertex and surface are ignored
  std::array<std::uint32_t, 4> particle{};  ///< the vertex, and the corners of the triangle nearest to it
  std::array<float, 4> c{};
  Vec3f direction{};  ///< unit
  float depth = 0;    ///< m
};

/// Order of garments. When two surfaces with different nonzero layers collide, the higher layer belongs over the lower
/// one. Over means the side where the lower surface's triangles are counter-clockwise. The winding of the upper surface
/// does not matter.
///
/// A point x is over the lower surface when
///
///   n . (x - y) >= 0,
///
/// Here y is the point of the surface nearest to x, and n the normal at y. It is the triangle's normal, the mean of two
/// at an edge, or the angle-weighted mean at a vertex. Then the sign is right in folds, and wherever the surface has an
/// inside. See Baerentzen and Aanaes 2005, "Signed distance computation using the angle weighted pseudonormal".
///
/// Points farther away than a twentieth of the lower surface's size, or beyond its border, are no violations.
/// If the lower surface is closed, a point inside is one at any depth.
///
/// Two kinds of points are tested: vertices of the upper surface, and the points of its triangles nearest to
/// vertices of the lower surface. Edges through triangles are found by IntersectionFinder; `outward` gives
/// their direction.
class Layers {
 public:
  Layers() = default;
  explicit Layers(std::span<const ContactSurface> surfaces);
  /// Whether any pair of surfaces has an order.
  bool any() const { return !pairs_.empty(); }
  /// Whether surfaces a and b have an order.
  bool ordered(std::uint32_t a, std::uint32_t b) const { return ordered_.contains(a, b); }
  const ObjectPairs& ordered() const { return ordered_; }

  /// Finds the layer violations at the current positions, of pairs of surfaces in `enabled`.
  /// `finder` must have the same surfaces. Violations are sorted by pair, then vertex, and do not depend on
  /// the number of threads.
  void find(const ParticleView& particles, const IntersectionFinder& finder, const ObjectPairs& enabled,
            Threads& threads);
  std::span<const LayerViolation> found() const { return found_; }
  /// Whether the vertex is on the wrong side of the surface, so that contacts must ignore it.
  bool is_exempt(std::uint32_t vertex, std::uint32_t surface) const;

  /// Unit vector along which an edge must move, relative to the triangle it passes through, to restore the
  /// order. Uses the positions of the last `find`; the two surfaces must have an order.
  Vec3f outward(const EdgeIntersection& intersection, const ParticleView& particles,
                const IntersectionFinder& finder) const;

  std::size_t bytes() const;

 private:
  struct Pair {
    std::uint32_t lower, upper;
  };
  struct Surface {
    std::uint32_t begin = 0, end = 0;  // particles
    int layer = 0;
    bool active = false;  // part of an enabled pair
    Bounds bounds{};
  };
  /// The point of a surface nearest to a query point.
  struct Nearest {
    std::uint32_t triangle = SurfaceElement::no_edge;
    std::array<float, 3> weight{};
    Vec3f offset{};  // from it to the query point
  };

  void find_bounds(const ParticleView& particles, const ObjectPairs& enabled);
  void find_normals(const ParticleView& particles, const IntersectionFinder& finder);
  void build_hash(const ParticleView& particles, const IntersectionFinder& finder, Threads& threads);
  Nearest nearest(const ParticleView& particles, const IntersectionFinder& finder, std::uint32_t i,
                  const Vec3f& shift, std::uint32_t surface, float range,
                  std::vector<std::uint32_t>& near) const;
  Vec3f normal_at(const Nearest& nearest, const ParticleView& particles, const IntersectionFinder& finder,
                  bool& border) const;
  bool is_under(const Nearest& nearest, const ParticleView& particles, const IntersectionFinder& finder,
                float size, Vec3f& normal) const;
  bool test_upper(const Pair& pair, std::uint32_t i, const ParticleView& particles,
                  const IntersectionFinder& finder, std::vector<std::uint32_t>& near,
                  LayerViolation& found) const;
  bool test_lower(const Pair& pair, std::uint32_t i, const ParticleView& particles,
                  const IntersectionFinder& finder, std::vector<std::uint32_t>& near,
                  LayerViolation& found) const;
  float search_range(const Pair& pair) const;
  void find_pair(const Pair& pair, const ParticleView& particles, const IntersectionFinder& finder,
                 Threads& threads);

  std::vector<Surface> surfaces_;
  std::vector<Pair> pairs_;
  ObjectPairs ordered_;
  std::vector<Vec3f> vertex_normal_, edge_normal_;  // per particle, per edge; not normalized
  std::vector<std::uint8_t> at_border_;             // per particle
  std::vector<Bounds> boxes_;                       // per triangle
  SpatialHash hash_;
  float cell_size_ = 1;                                   // m
  std::vector<LayerViolation> violation_of_;              // per vertex, in find_pair
  std::vector<std::uint8_t> is_violation_;                // per vertex, in find_pair
  std::vector<std::uint8_t> has_exemption_;               // per particle
  std::vector<std::array<std::uint32_t, 2>> exemptions_;  // pairs of vertex and surface, sorted
  std::vector<LayerViolation> found_;
};

}  // namespace souple
