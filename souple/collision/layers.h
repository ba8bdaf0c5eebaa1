#pragma once

#include "souple/collision/intersection_finder.h"

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace souple {

/// A point of an upper surface that lies under a lower one. What puts it right moves particles along
/// `direction`, outward, with the weights c: sum_k c_k x_k is the point of the upper surface less that of the
/// lower one.
struct LayerViolation {
  std::uint32_t vertex = 0, surface = 0;    ///< this vertex may pass this surface until it is right
  std::array<std::uint32_t, 4> particle{};  ///< the vertex, and the corners of the triangle it is nearest to
  std::array<float, 4> c{};
  Vec3f direction{};  ///< unit
  float depth = 0;    ///< m
};

/// Layers of cloth. Of two surfaces that meet and have different layers, neither of them 0, the one of the
/// higher layer belongs over the other one: on the side where the triangles of the lower one are
/// counter-clockwise. Only these say what is outside; how the upper one is wound does not matter.
///
/// A point x is over the lower surface when
///
///   n . (x - y) >= 0,
///
/// y the point of the surface nearest to x and n its normal there: of the triangle, the mean of two at an
/// edge, weighted by angles at a vertex. Then the sign is right wherever the surface has an inside
/// (Baerentzen and Aanaes 2005, "Signed distance computation using the angle weighted pseudonormal"), and in
/// folds. Farther offset than a twentieth of the lower surface's size nothing is wrong, nor beyond its border,
/// unless the lower surface is closed: what is inside of that is wrong at any depth.
///
/// Two kinds of points are active: vertices of the upper surface, and where its triangles are nearest to
/// vertices of the lower one. Edges through triangles are left to IntersectionFinder; `outward` tells where they go.
class Layers {
 public:
  /// As IntersectionFinder::set_surfaces.
  void set_surfaces(std::span<const ContactSurface> surfaces);
  /// Whether there is any pair of them.
  bool any() const { return !pairs_.empty(); }
  /// Whether one of the two belongs over the other.
  bool ordered(std::uint32_t a, std::uint32_t b) const {
    return !pairs_.empty() && a != b && ordered_.at(a, b);
  }

  /// What lies wrong now, between surfaces so marked. `finder` must have been given the same surfaces. In
  /// order of pairs, then vertices: the same for any number of threads.
  void find(const ParticleView& particles, const IntersectionFinder& finder, const ObjectMatrix& enabled,
            Threads& threads);
  std::span<const LayerViolation> found() const { return found_; }
  /// Whether the vertex is on the wrong side of the surface: contacts must let it pass.
  bool is_exempt(std::uint32_t vertex, std::uint32_t surface) const;

  /// Where an edge must go, against the triangle that it passes through, for the two surfaces to lie right: a
  /// unit vector. Of the positions that `find` saw; the surfaces must be ordered.
  Vec3f outward(const EdgeIntersection& crossing, const ParticleView& particles,
                const IntersectionFinder& finder) const;

  std::size_t bytes() const;

 private:
  struct Pair {
    std::uint32_t lower, upper;
  };
  struct Surface {
    std::uint32_t begin = 0, end = 0;  // particles
    int layer = 0;
    bool active = false;  // in the current find
    Bounds bounds{};
  };
  /// The point of a surface nearest to one that is active for.
  struct Nearest {
    std::uint32_t triangle = SurfaceElement::no_edge;
    std::array<float, 3> weight{};
    Vec3f offset{};  // from it to the point that was active for
  };

  void find_bounds(const ParticleView& particles, const ObjectMatrix& enabled);
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
  ObjectMatrix ordered_;
  std::vector<Vec3f> vertex_normal_, edge_normal_;  // of particles, edges
  std::vector<std::uint8_t> at_border_;             // of particles
  std::vector<Bounds> boxes_;                       // of triangles
  SpatialHash hash_;
  float cell_size_ = 1;                                   // m
  std::vector<LayerViolation> violation_of_;              // of the pair that is looked at
  std::vector<std::uint8_t> is_violation_;                // of vertices, likewise
  std::vector<std::uint8_t> has_exemption_;               // of particles
  std::vector<std::array<std::uint32_t, 2>> exemptions_;  // vertex and surface, sorted
  std::vector<LayerViolation> found_;
};

}  // namespace souple
