#pragma once

#include "souple/collision/contact_surface.h"
#include "souple/collision/near_pairs.h"
#include "souple/collision/spatial_hash.h"
#include "souple/collision/surface_elements.h"
#include "souple/solver/projector.h"
#include "souple/solver/threads.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace souple {

/// An edge that passes through a triangle, of two objects or of one. Edge and triangle meet where
/// sum_k c_k x_k = 0, so opposite forces on the two, shared out by c_k, keep momentum and angular momentum.
struct TangledEdge {
  std::uint32_t edge = 0, triangle = 0;         ///< of SurfaceElements
  std::uint32_t edge_surface = 0, surface = 0;  ///< whose the edge and the triangle are
  std::array<std::uint32_t, 5> particle{};      ///< ends of the edge, corners of the triangle
  std::array<float, 5> c{};                     ///< weights of the ends; minus those of the corners
};

/// Where a line goes through a surface.
struct SurfaceHit {
  int count = 0;                                     ///< how often
  std::uint32_t triangle = SurfaceElement::no_edge;  ///< the first on the way
  std::array<float, 3> weight{};                     ///< of its corners, where the line meets it
};

/// Finds what is tangled: edges that pass through triangles. What meets nothing, shares a particle or is tied
/// together is left out. An edge that only touches does not count, nor does one that lies in the triangle's
/// plane.
class Tangles {
 public:
  /// As ElementPairs::set_surfaces; `surfaces` is read now and not kept.
  void set_surfaces(std::span<const ContactSurface> surfaces);
  /// As ElementPairs::exclude.
  void exclude(std::vector<std::array<std::uint32_t, 2>> pairs);

  /// Where particles are now. By edge, then triangle: the same for any number of threads. Allocates nothing
  /// when warm.
  void find(const ParticleView& particles, Threads& threads) { find(particles, meets_, threads); }
  /// Only of objects that are so marked, which must be some that meet.
  void find(const ParticleView& particles, const ObjectMatrix& of, Threads& threads);
  std::span<const TangledEdge> edges() const { return found_; }

  // For those who pull them apart; of the positions that `find` saw.

  const SurfaceElements& elements() const { return elements_; }
  std::size_t surface_count() const { return closed_.size(); }
  /// Whether a surface is watertight and wound outward all over, so that it has an inside.
  bool is_closed(std::size_t surface) const { return closed_[surface] != 0; }
  const Bounds& bounds(std::size_t surface) const { return surface_bounds_[surface]; }
  /// Corners opposite to an edge in up to two triangles; no_edge where there is none.
  const std::array<std::uint32_t, 2>& opposite(std::size_t edge) const { return opposite_[edge]; }
  /// Whether there is anything that meets something.
  bool any_pair() const { return any_pair_; }
  /// Whether two particles are an excluded pair.
  bool are_tied(std::uint32_t i, std::uint32_t j) const {
    return std::binary_search(excluded_.begin(), excluded_.end(), std::array<std::uint32_t, 2>{i, j});
  }
  std::uint32_t surface_of(std::size_t particle) const { return surface_of_[particle]; }

  /// Looks from x_i + shift along a unit vector, to 1e-3, as far as the surface reaches. `side`, 1 or -1: to
  /// which side x_i is displaced by some 1e-6 of the smaller object, in case that it lies on the surface.
  SurfaceHit look(const ParticleView& particles, std::uint32_t i, const Vec3f& shift, const Vec3f& direction,
                  std::uint32_t surface, float side) const;
  /// Whether the edge would pass through some triangle of `surface` that reaches into `region`, were it
  /// displaced by `shift`.
  bool passes(const ParticleView& particles, std::uint32_t edge, const Vec3f& shift, std::uint32_t surface,
              const Bounds& region) const;
  std::size_t bytes() const;

 private:
  struct Chunk {
    std::vector<TangledEdge> edges;
    std::vector<std::uint32_t> near, also;
  };

  void find_closed(std::span<const ContactSurface> surfaces);
  void find_opposite();
  void find_active(const ParticleView& particles, const ObjectMatrix& of);
  bool may_cross(const Bounds& box, std::uint32_t surface, const ObjectMatrix& of) const;
  void find_boxes(const ParticleView& particles, Threads& threads);
  void find_chunk(const ParticleView& particles, const ObjectMatrix& of, std::size_t chunk);
  bool is_excluded(const TangledEdge& pair) const;
  Vec3f displacement(std::uint32_t edge_surface, std::uint32_t surface) const;
  Bounds box_of(const ParticleView& particles, const Edge& edge, std::uint32_t owner) const;

  SurfaceElements elements_;
  ObjectMatrix meets_;
  bool any_pair_ = false;
  std::vector<std::array<std::uint32_t, 2>> excluded_;  // both ways, sorted
  std::vector<std::array<std::uint32_t, 2>> ranges_;    // particles of each surface
  std::vector<std::uint32_t> surface_of_;               // of each particle
  std::vector<std::array<std::uint32_t, 2>> opposite_;  // of each edge
  std::vector<std::uint8_t> closed_, active_;           // of each surface
  std::vector<Bounds> surface_bounds_, boxes_;          // of surfaces and triangles
  SpatialHash hash_;
  float cell_size_ = 1;  // m
  std::vector<Chunk> chunks_;
  std::vector<TangledEdge> found_;
};

}  // namespace souple
