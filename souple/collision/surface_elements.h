#pragma once

#include "souple/geometry/adjacency.h"

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace souple {

/// A triangle, a loose edge or a loose vertex of some object.
struct SurfaceElement {
  static constexpr std::uint32_t no_edge = TriangleEdges::no_edge;
  std::uint32_t particle[3]{};  ///< corners; those that an edge or a vertex lacks repeat the last one
  std::uint32_t edge[3]{no_edge, no_edge,
                        no_edge};  ///< side k joins corners k and (k + 1) % 3; no_edge where there is none
  std::uint32_t object = 0;        ///< whose it is
  std::uint8_t corners = 0;        ///< 3, 2 or 1
  std::uint8_t owns_particle = 0;  ///< bit k: corner k belongs to this element and to no other
  std::uint8_t owns_edge = 0;      ///< bit k: so does side k
};

/// Neighboring elements and what they own, all in a row: triangles, edges and vertices
/// [begin, begin + count).
struct SurfacePatch {
  static constexpr std::uint32_t max_triangles = 15, max_edges = 8;  ///< max_edges: of a rope
  std::uint32_t first_triangle = 0, first_edge = 0, first_vertex = 0;
  std::uint32_t object = 0;
  std::uint8_t triangles = 0, edges = 0, vertices = 0;
};

/// What can touch: all surfaces, ropes and grains of a world, by the numbers of their particles. Built when
/// objects come and go, not in a step. Elements are numbered by patches: the triangles of a mesh in another
/// order than its own, so that neighbors follow one another. Vertices and edges are numbered in the order of
/// the elements; each is there once, and belongs to the first element that has it.
class SurfaceElements {
 public:
  /// A mesh's surface. Its vertex i is particle first_particle + i; a vertex that no triangle has is left
  /// out, and so is a triangle with a repeated corner. One object may be added in several calls, if they
  /// share no particle.
  void add_triangles(std::span<const Triangle> triangles, std::uint32_t first_particle, std::uint32_t object);
  /// Edges that no triangle has: a rope. One from a vertex to itself is left out.
  void add_edges(std::span<const Edge> edges, std::uint32_t first_particle, std::uint32_t object);
  /// Particles [begin, end), each alone: grains.
  void add_particles(std::uint32_t begin, std::uint32_t end, std::uint32_t object);
  void clear();

  std::span<const SurfaceElement> elements() const { return elements_; }
  /// Those that are triangles, in the same order.
  std::span<const SurfaceElement> triangles() const { return triangles_; }
  /// Particles of each edge.
  std::span<const Edge> edges() const { return edges_; }
  std::span<const std::uint32_t> edge_objects() const { return edge_objects_; }
  /// Particle of each vertex.
  std::span<const std::uint32_t> vertices() const { return vertices_; }
  std::span<const std::uint32_t> vertex_objects() const { return vertex_objects_; }
  std::span<const SurfacePatch> patches() const { return patches_; }
  /// Lists which patches name a particle, after the last add; ascending.
  void index_particles();
  std::span<const std::uint32_t> patches_of(std::uint32_t particle) const {
    return std::span(patches_of_)
        .subspan(patches_begin_[particle], patches_begin_[particle + 1] - patches_begin_[particle]);
  }
  /// Particles that elements of a patch name; some of them several times.
  template <class Function>
  void for_each_particle(const SurfacePatch& patch, const Function& function) const;
  /// The particles of all vertices, edges or triangles, corner by corner, and `padding` zeros behind the
  /// last.
  static constexpr std::size_t padding = 32;
  const std::uint32_t* vertex_particles() const { return vertex_particles_.data(); }
  const std::uint32_t* edge_particles(std::size_t corner) const { return edge_particles_[corner].data(); }
  const std::uint32_t* triangle_particles(std::size_t corner) const {
    return triangle_particles_[corner].data();
  }

  /// One more than the largest particle and the largest object that are named.
  std::uint32_t particle_end() const { return particle_end_; }
  std::uint32_t object_end() const { return object_end_; }
  std::size_t bytes() const;

 private:
  void assign_particle_owners(std::size_t first_element);
  void add_patches(std::size_t first_element, std::span<const std::uint32_t> sizes);
  void extend_columns();

  std::uint32_t particle_end_ = 0, object_end_ = 0;
  std::vector<SurfaceElement> elements_, triangles_;
  std::vector<Edge> edges_;
  std::vector<std::uint32_t> edge_objects_, vertices_, vertex_objects_;
  std::vector<SurfacePatch> patches_;
  std::vector<std::uint32_t> patches_begin_, patches_of_;  // of each particle
  std::vector<std::uint32_t> vertex_particles_;
  std::array<std::vector<std::uint32_t>, 2> edge_particles_;
  std::array<std::vector<std::uint32_t>, 3> triangle_particles_;
};

template <class Function>
void SurfaceElements::for_each_particle(const SurfacePatch& patch, const Function& function) const {
  for (std::uint32_t t = patch.first_triangle; t < patch.first_triangle + patch.triangles; ++t)
    for (const std::uint32_t i : triangles_[t].particle) function(i);
  for (std::uint32_t e = patch.first_edge; e < patch.first_edge + patch.edges; ++e)
    for (const std::uint32_t i : edges_[e]) function(i);
  for (std::uint32_t v = patch.first_vertex; v < patch.first_vertex + patch.vertices; ++v)
    function(vertices_[v]);
}

}  // namespace souple
