#include "souple/collision/surface_elements.h"

#include "souple/state/bytes.h"

#include <algorithm>

namespace souple {

// Marks the corners that no earlier element of this call has, and lists them as vertices.
void SurfaceElements::own_particles_once(std::size_t first_element) {
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
  const TriangleEdges sides = triangle_edges(triangles);
  const std::size_t first_element = elements_.size(), first_edge = edges_.size();
  std::vector<bool> owned(sides.edges.size());
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    const auto& [a, b, c] = triangles[t];
    if (a == b || b == c || c == a) continue;
    SurfaceElement element;
    element.object = object;
    element.corners = 3;
    for (unsigned k = 0; k < 3; ++k) {
      const std::uint32_t edge = sides.of_triangle[t][k];
      element.particle[k] = first_particle + triangles[t][k];
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
  own_particles_once(first_element);
  object_end_ = std::max(object_end_, object + 1);
  triangles_.insert(triangles_.end(), elements_.begin() + static_cast<std::ptrdiff_t>(first_element),
                    elements_.end());
}

void SurfaceElements::add_edges(std::span<const Edge> edges, std::uint32_t first_particle,
                                std::uint32_t object) {
  const std::size_t first_element = elements_.size();
  for (const Edge& edge : edges) {
    const std::uint32_t a = first_particle + edge[0], b = first_particle + edge[1];
    if (a == b) continue;
    const auto index = static_cast<std::uint32_t>(edges_.size());
    elements_.push_back(
        {{a, b, b}, {index, SurfaceElement::no_edge, SurfaceElement::no_edge}, object, 2, 0, 1});
    edges_.push_back({a, b});
    edge_objects_.push_back(object);
  }
  own_particles_once(first_element);
  object_end_ = std::max(object_end_, object + 1);
}

void SurfaceElements::add_particles(std::uint32_t begin, std::uint32_t end, std::uint32_t object) {
  constexpr std::uint32_t none = SurfaceElement::no_edge;
  for (std::uint32_t i = begin; i < end; ++i) {
    elements_.push_back({{i, i, i}, {none, none, none}, object, 1, 1, 0});
    vertices_.push_back(i);
    vertex_objects_.push_back(object);
  }
  particle_end_ = std::max(particle_end_, end);
  object_end_ = std::max(object_end_, object + 1);
}

void SurfaceElements::clear() {
  *this = {};
}

std::size_t SurfaceElements::bytes() const {
  return bytes_of(elements_, triangles_, edges_, edge_objects_, vertices_, vertex_objects_);
}

}  // namespace souple
