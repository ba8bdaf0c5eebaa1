#pragma once

#include "souple/geometry/adjacency.h"
#include "souple/geometry/builders.h"

#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace souple::test {

/// Constraints to color, by their particles.
struct ColorCase {
  std::string name;
  std::vector<std::uint32_t> indices;
  int arity = 2;
  std::size_t particles = 0;
  std::size_t max_colors = 0;  ///< one or two above the needed number

  std::size_t count() const { return indices.size() / static_cast<std::size_t>(arity); }
  std::span<const std::uint32_t> constraint(std::size_t i) const {
    const auto width = static_cast<std::size_t>(arity);
    return std::span(indices).subspan(i * width, width);
  }
};

template <class Element>
ColorCase color_case(const std::string& name, const std::vector<Element>& elements, std::size_t particles,
                     std::size_t max_colors) {
  ColorCase result{name, {}, static_cast<int>(std::tuple_size_v<Element>), particles, max_colors};
  for (const Element& element : elements)
    result.indices.insert(result.indices.end(), element.begin(), element.end());
  return result;
}

/// Edges, and distances across interior edges.
inline std::vector<Edge> springs(const TriangleMesh& mesh) {
  std::vector<Edge> all = unique_edges(mesh.triangles);
  for (const Hinge& hinge : interior_edges(mesh.triangles)) all.push_back({hinge[2], hinge[3]});
  return all;
}

/// Cloths of n x n vertices, balls, and a bar of about 180 n tets.
inline std::vector<ColorCase> meshes_to_color(int n) {
  const TriangleMesh cloth = grid(n, n, 2), slanted = grid(n, n, 2, Diagonals::one_way);
  const TriangleMesh ball = sphere(5, 1);
  const TetMesh bar = tet_bar(n / 4, 12, 12, {5, 1, 1});
  const std::size_t c = cloth.positions.size(), b = ball.positions.size(), t = bar.positions.size();
  return {color_case("cloth edges", unique_edges(cloth.triangles), c, 8),
          color_case("cloth springs", springs(cloth), c, 16),
          color_case("cloth hinges", interior_edges(cloth.triangles), c, 19),
          color_case("cloth triangles", cloth.triangles, c, 8),
          color_case("slanted edges", unique_edges(slanted.triangles), c, 6),
          color_case("slanted springs", springs(slanted), c, 13),
          color_case("slanted hinges", interior_edges(slanted.triangles), c, 14),
          color_case("slanted triangles", slanted.triangles, c, 8),
          color_case("tets", bar.tets, t, 39),
          color_case("tet edges", unique_edges(bar.tets), t, 19),
          color_case("ball edges", unique_edges(ball.triangles), b, 8),
          color_case("ball springs", springs(ball), b, 15),
          color_case("ball hinges", interior_edges(ball.triangles), b, 19),
          color_case("ball triangles", ball.triangles, b, 10)};
}

/// Star of edges that all share particle 0.
inline ColorCase star(std::uint32_t rays) {
  std::vector<Edge> edges;
  for (std::uint32_t i = 1; i <= rays; ++i) edges.push_back({0, i});
  return color_case("star", edges, rays + 1, rays);
}

}  // namespace souple::test
