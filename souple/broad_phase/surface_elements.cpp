#include "souple/broad_phase/surface_elements.h"

#include "souple/math/lists.h"
#include "souple/state/bytes.h"

#include <algorithm>
#include <bit>

namespace souple {
namespace {

constexpr std::uint32_t no_particle = ~std::uint32_t{0};

/// Triangles in the order of patches, and the number of triangles of each patch.
struct Grouped {
  std::vector<Triangle> triangles;
  std::vector<std::uint32_t> sizes;
};

/// Grows patches over a mesh. A patch starts at one triangle and adds, of the free triangles at its edges,
/// the one with the most corners in the patch. So it closes the fan around a vertex and stays round.
class PatchGrower {
 public:
  explicit PatchGrower(std::span<const Triangle> triangles)
      : triangles_(triangles),
        sides_(triangle_edges(triangles)),
        triangles_of_edge_(sides_.edges.size(),
                           [this](const auto& add) {
                             for (std::uint32_t t = 0; t < sides_.of_triangle.size(); ++t)
                               for (const std::uint32_t e : sides_.of_triangle[t]) add(e, t);
                           }),
        used_(triangles.size()) {
    std::uint32_t vertices = 0;
    for (const Triangle& t : triangles) vertices = std::max({vertices, t[0] + 1, t[1] + 1, t[2] + 1});
    patch_of_.resize(vertices);
  }

  Grouped grow() {
    Grouped result;
    for (std::uint32_t seed = 0; seed < triangles_.size(); ++seed) {
      if (used_[seed]) continue;
      patch_.clear();
      ++patches_;
      for (std::uint32_t t = seed; t != none; t = next()) add(t);
      for (const std::uint32_t t : patch_) result.triangles.push_back(triangles_[t]);
      result.sizes.push_back(static_cast<std::uint32_t>(patch_.size()));
    }
    return result;
  }

 private:
  static constexpr std::uint32_t none = ~std::uint32_t{0};

  void add(std::uint32_t t) {
    used_[t] = true;
    patch_.push_back(t);
    for (const std::uint32_t i : triangles_[t]) patch_of_[i] = patches_;
  }
  long corners_in_patch(std::uint32_t t) const {
    return std::count_if(triangles_[t].begin(), triangles_[t].end(),
                         [this](std::uint32_t i) { return patch_of_[i] == patches_; });
  }
  std::uint32_t next() const {
    if (patch_.size() == SurfacePatch::max_triangles) return none;
    std::uint32_t best = none;
    long max_corners = 0;
    for (const std::uint32_t p : patch_)
      for (const std::uint32_t e : sides_.of_triangle[p])
        for (const std::uint32_t t : triangles_of_edge_[e]) {
          if (used_[t]) continue;
          const long corners = corners_in_patch(t);
          if (corners > max_corners) best = t, max_corners = corners;
          if (max_corners == 3) return best;
        }
    return best;
  }

  std::span<const Triangle> triangles_;
  TriangleEdges sides_;
  Lists<std::uint32_t> triangles_of_edge_;
  std::vector<bool> used_;
  std::vector<std::uint32_t> patch_;
  std::vector<std::uint32_t> patch_of_;  // per vertex: number of the last patch that has it, from 1
  std::uint32_t patches_ = 0;            // number of this patch
};

}  // namespace

// Adds the patches of new elements; sizes: number of elements of each patch. The edges and vertices that an
// element owns follow those of the element before it.
void SurfaceElements::add_patches(std::size_t first_element, std::span<const std::uint32_t> sizes) {
  auto e = elements_.begin() + static_cast<std::ptrdiff_t>(first_element);
  for (const std::uint32_t size : sizes) {
    SurfacePatch patch;
    if (!patches_.empty()) {
      const SurfacePatch& last = patches_.back();
      patch.first_triangle = last.first_triangle + last.triangles;
      patch.first_edge = last.first_edge + last.edges;
      patch.first_vertex = last.first_vertex + last.vertices;
    }
    patch.object = e->object;
    for (std::uint32_t k = 0; k < size; ++k, ++e) {
      patch.triangles = static_cast<std::uint8_t>(patch.triangles + (e->corners == 3 ? 1 : 0));
      patch.edges =
          static_cast<std::uint8_t>(patch.edges + std::popcount(static_cast<unsigned>(e->owns_edge)));
      patch.vertices =
          static_cast<std::uint8_t>(patch.vertices + std::popcount(static_cast<unsigned>(e->owns_particle)));
    }
    patches_.push_back(patch);
  }
  extend_columns();
}

void SurfaceElements::extend_columns() {
  const auto extend = [](std::vector<std::uint32_t>& column, std::size_t size, const auto& particle) {
    std::size_t i = column.size() - std::min(column.size(), padding);
    column.resize(size + padding);
    for (; i < size; ++i) column[i] = particle(i);
    std::fill(column.begin() + static_cast<std::ptrdiff_t>(size), column.end(), 0u);
  };
  extend(vertex_particles_, vertices_.size(), [this](std::size_t i) { return vertices_[i]; });
  for (std::size_t k = 0; k < 2; ++k)
    extend(edge_particles_[k], edges_.size(), [&](std::size_t i) { return edges_[i][k]; });
  for (std::size_t k = 0; k < 3; ++k)
    extend(triangle_particles_[k], triangles_.size(),
           [&](std::size_t i) { return triangles_[i].particle[k]; });
}

// An element owns the corners that no earlier element of this call has. Adds them to the vertices.
void SurfaceElements::assign_particle_owners(std::size_t first_element) {
  std::uint32_t end = 0;
  for (std::size_t e = first_element; e < elements_.size(); ++e)
    for (const std::uint32_t i : elements_[e].particle) end = std::max(end, i + 1);
  particle_end_ = std::max(particle_end_, end);
  std::vector<bool> owned(end);
  for (std::size_t e = first_element; e < elements_.size(); ++e) {
    SurfaceElement& element = elements_[e];
    for (unsigned k = 0; k < element.corners; ++k) {
      const std::uint32_t i = element.particle[k];
      if (owned[i]) continue;
      owned[i] = true;
      element.owns_particle = static_cast<std::uint8_t>(element.owns_particle | 1u << k);
      vertices_.push_back(i);
      vertex_objects_.push_back(element.object);
    }
  }
}

void SurfaceElements::add_triangles(std::span<const Triangle> triangles, std::uint32_t first_particle,
                                    std::uint32_t object) {
  std::vector<Triangle> valid;
  for (const Triangle& t : triangles)
    if (t[0] != t[1] && t[1] != t[2] && t[2] != t[0]) valid.push_back(t);
  const Grouped grouped = PatchGrower(valid).grow();
  const TriangleEdges sides = triangle_edges(grouped.triangles);
  const std::size_t first_element = elements_.size(), first_edge = edges_.size();
  std::vector<bool> owned(sides.edges.size());
  for (std::size_t t = 0; t < grouped.triangles.size(); ++t) {
    SurfaceElement element;
    element.object = object;
    element.corners = 3;
    for (unsigned k = 0; k < 3; ++k) {
      const std::uint32_t edge = sides.of_triangle[t][k];
      element.particle[k] = first_particle + grouped.triangles[t][k];
      element.edge[k] = static_cast<std::uint32_t>(first_edge) + edge;
      if (owned[edge]) continue;
      owned[edge] = true;
      element.owns_edge = static_cast<std::uint8_t>(element.owns_edge | 1u << k);
    }
    elements_.push_back(element);
  }
  for (const Edge& edge : sides.edges) {
    edges_.push_back({first_particle + edge[0], first_particle + edge[1]});
    edge_objects_.push_back(object);
  }
  assign_particle_owners(first_element);
  triangles_.insert(triangles_.end(), elements_.begin() + static_cast<std::ptrdiff_t>(first_element),
                    elements_.end());
  add_patches(first_element, grouped.sizes);
}

void SurfaceElements::add_edges(std::span<const Edge> edges, std::uint32_t first_particle,
                                std::uint32_t object) {
  const std::size_t first_element = elements_.size();
  std::vector<std::uint32_t> sizes;
  std::uint32_t last = no_particle;
  for (const Edge& edge : edges) {
    const std::uint32_t a = first_particle + edge[0], b = first_particle + edge[1];
    if (a == b) continue;
    if (a != last || sizes.back() == SurfacePatch::max_edges) sizes.push_back(0);
    ++sizes.back();
    last = b;
    const auto index = static_cast<std::uint32_t>(edges_.size());
    elements_.push_back(
        {{a, b, b}, {index, SurfaceElement::no_edge, SurfaceElement::no_edge}, object, 2, 0, 1});
    edges_.push_back({a, b});
    edge_objects_.push_back(object);
  }
  assign_particle_owners(first_element);
  add_patches(first_element, sizes);
}

void SurfaceElements::add_particles(std::uint32_t begin, std::uint32_t end, std::uint32_t object) {
  constexpr std::uint32_t none = SurfaceElement::no_edge;
  const std::size_t first_element = elements_.size();
  for (std::uint32_t i = begin; i < end; ++i) {
    elements_.push_back({{i, i, i}, {none, none, none}, object, 1, 1, 0});
    vertices_.push_back(i);
    vertex_objects_.push_back(object);
  }
  particle_end_ = std::max(particle_end_, end);
  const std::vector<std::uint32_t> sizes(elements_.size() - first_element, 1);
  add_patches(first_element, sizes);
}

void SurfaceElements::index_particles() {
  std::vector<std::uint32_t> last(particle_end_);
  patches_of_.fill(particle_end_, [&](const auto& add) {
    std::fill(last.begin(), last.end(), no_particle);
    for (std::uint32_t p = 0; p < patches_.size(); ++p)
      for_each_particle(patches_[p], [&](std::uint32_t i) {
        if (last[i] != p) add(i, p);
        last[i] = p;
      });
  });
}

void SurfaceElements::clear() {
  *this = {};
}

std::size_t SurfaceElements::bytes() const {
  return bytes_of(elements_, triangles_, edges_, edge_objects_, vertices_, vertex_objects_, patches_,
                  vertex_particles_, edge_particles_[0], edge_particles_[1], triangle_particles_[0],
                  triangle_particles_[1], triangle_particles_[2]) +
         patches_of_.bytes();
}

}  // namespace souple
