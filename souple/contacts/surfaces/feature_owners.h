#pragma once

#include "souple/contacts/surfaces/element_surfaces.h"
#include "souple/math/lists.h"
#include "souple/solver/projector.h"

#include <array>
#include <cstdint>
#include <vector>

namespace souple {

/// A point near a surface: a particle, or `offset` away from it.
struct SurfacePoint {
  const ParticleView& particles;
  std::uint32_t particle;
  Vec3f offset{};         ///< m
  bool at_start = false;  ///< of the motion; else at its end

  /// The way to a particle [m].
  Vec3f to(std::uint32_t i) const {
    const Vec3f way = particles.difference(i, particle) - offset;
    return at_start ? way - (particles.moved(i) - particles.moved(particle)) : way;
  }
};

/// Which triangle of a surface makes the contact with a vertex that is nearest to an edge or a corner of several
/// triangles. If the vertex is over none of the triangles around the feature, the first one of the mesh makes it.
/// If it is over one of them, only that triangle does: the normal from the edge would brake sliding vertices.
class FeatureOwners {
 public:
  void build(const ElementSurfaces& surfaces);
  /// Whether the triangle of a pair owns the feature where its point nearest to x lies: the triangle, an edge or a
  /// corner. Bit k of on_border: corner k has no weight.
  bool is_owner(const NearPair& pair, unsigned on_border, const SurfacePoint& x) const;
  /// Calls f(j, k) for the other corners of each triangle at vertex i.
  template <class Function>
  void for_each_triangle_at(std::uint32_t i, const Function& f) const {
    for (const VertexEdge& edge : edges_[i])
      if (edge.other < edge.opposite) f(edge.other, edge.opposite);
  }
  std::size_t bytes() const;

 private:
  /// An edge of a triangle, listed at one of its ends.
  struct VertexEdge {
    std::uint32_t other, opposite;  ///< the other end of the edge, and the opposite corner of the triangle
  };
  bool is_owner_of_edge(const NearPair& pair, std::size_t corner, const SurfacePoint& x) const;
  bool is_owner_of_corner(const NearPair& pair, std::size_t corner, const SurfacePoint& x) const;

  Lists<VertexEdge> edges_;  // per vertex: sorted by their other ends, then in the order of triangles
  std::vector<std::array<std::uint32_t, 3>> owner_of_vertex_;  // per particle: its first triangle
};

}  // namespace souple
