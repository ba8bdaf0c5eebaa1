#pragma once

#include "souple/geometry/adjacency.h"
#include "souple/math/lists.h"

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace souple {

/// A triangle, an edge without triangles, or a vertex without edges.
struct SurfaceElement {
  static constexpr std::uint32_t no_edge = TriangleEdges::no_edge;
  std::uint32_t particle[3]{};  ///< corners; an edge or a vertex repeats the last one
  std::uint32_t edge[3]{no_edge, no_edge,
                        no_edge};  ///< edge k joins corners k and (k + 1) % 3; no_edge if there is none
  std::uint32_t object = 0;        ///< index of the object
  std::uint8_t corners = 0;        ///< number of corners: 3, 2 or 1
  std::uint8_t owns_particle = 0;  ///< bit k: this element alone owns corner k
  std::uint8_t owns_edge = 0;      ///< bit k: this element alone owns edge k
};

/// Neighboring elements, and the edges and vertices they own. Indices are consecutive: triangles, edges and
/// vertices [first, first + count).
struct SurfacePatch {
  static constexpr std::uint32_t max_triangles = 15, max_edges = 8;  ///< max_edges: for ropes
  std::uint32_t first_triangle = 0, first_edge = 0, first_vertex = 0;
  std::uint32_t object = 0;
  std::uint8_t triangles = 0, edges = 0, vertices = 0;
};

/// All triangles, edges and vertices of a world that can be in contact: of surfaces, ropes and grains, by the
/// indices of their particles. Rebuilt when objects are added or removed, not in a step. Elements are
/// numbered by patches: the order of a mesh's triangles changes such that neighbors follow each other.
/// Vertices and edges are numbered in the order of elements. Each occurs once, and the first element that has
/// it owns it.
class SurfaceElements {
 public:
  /// Adds the triangles of a mesh. Its vertex i is particle first_particle + i. Vertices without triangles
  /// and triangles with a repeated corner are skipped. Several calls may add to one object, if they share no
  /// particle.
  void add_triangles(std::span<const Triangle> triangles, std::uint32_t first_particle, std::uint32_t object);
  /// Adds edges without triangles, of a rope. An edge from a vertex to itself is skipped.
  void add_edges(std::span<const Edge> edges, std::uint32_t first_particle, std::uint32_t object);
  /// Adds particles [begin, end), each a vertex without edges: grains.
  void add_particles(std::uint32_t begin, std::uint32_t end, std::uint32_t object);
  void clear();

  std::span<const SurfaceElement> elements() const { return elements_; }
  /// The elements that are triangles, in the order of elements.
  std::span<const SurfaceElement> triangles() const { return triangles_; }
  /// Particles of each edge.
  std::span<const Edge> edges() const { return edges_; }
  std::span<const std::uint32_t> edge_objects() const { return edge_objects_; }
  /// Particle of each vertex.
  std::span<const std::uint32_t> vertices() const { return vertices_; }
  std::span<const std::uint32_t> vertex_objects() const { return vertex_objects_; }
  std::span<const SurfacePatch> patches() const { return patches_; }
  /// Builds the ascending lists of patches_of. Call after the last add.
  void index_particles();
  /// Patches with elements that have the particle.
  std::span<const std::uint32_t> patches_of(std::uint32_t particle) const { return patches_of_[particle]; }
  /// Calls function(particle) for all corners of the elements of a patch; some particles occur several times.
  template <class Function>
  void for_each_particle(const SurfacePatch& patch, const Function& function) const;
  /// Particles of all vertices, edges or triangles as arrays, one per corner, with `padding` zeros at the
  /// end.
  static constexpr std::size_t padding = 32;
  const std::uint32_t* vertex_particles() const { return vertex_particles_.data(); }
  const std::uint32_t* edge_particles(std::size_t corner) const { return edge_particles_[corner].data(); }
  const std::uint32_t* triangle_particles(std::size_t corner) const {
    return triangle_particles_[corner].data();
  }

  /// One more than the largest index of a particle.
  std::uint32_t particle_end() const { return particle_end_; }
  std::size_t bytes() const;

 private:
  void assign_particle_owners(std::size_t first_element);
  void add_patches(std::size_t first_element, std::span<const std::uint32_t> sizes);
  void extend_columns();

  std::uint32_t particle_end_ = 0;
  std::vector<SurfaceElement> elements_, triangles_;
  std::vector<Edge> edges_;
  std::vector<std::uint32_t> edge_objects_, vertices_, vertex_objects_;
  std::vector<SurfacePatch> patches_;
  Lists<std::uint32_t> patches_of_;  // per particle
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
