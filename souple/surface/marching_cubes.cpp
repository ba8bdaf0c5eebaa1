#include "souple/surface/marching_cubes.h"

#include "souple/geometry/measures.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <utility>

namespace souple {

namespace {

using kernels::brick_side;

// --- the table of cases

struct CubeEdge {
  std::size_t axis, node;  // its direction and its first node
};

constexpr CubeEdge cube_edge(std::size_t edge) {
  const std::size_t axis = edge / 4, next = (axis + 1) % 3, after = (axis + 2) % 3;
  return {axis, (edge & 1) << next | (edge >> 1 & 1) << after};
}

constexpr std::size_t edge_between(std::size_t a, std::size_t b) {
  std::size_t found = 0;
  for (std::size_t e = 0; e < 12; ++e) {
    const CubeEdge edge = cube_edge(e);
    const std::size_t other = edge.node | std::size_t{1} << edge.axis;
    if ((edge.node == a && other == b) || (edge.node == b && other == a)) found = e;
  }
  return found;
}

/// Bits of the two faces that contain an edge: bit 2 axis + side.
constexpr unsigned faces_of(std::size_t e) {
  const CubeEdge edge = cube_edge(e);
  unsigned faces = 0;
  for (std::size_t axis = 0; axis < 3; ++axis)
    if (axis != edge.axis) faces |= 1u << (2 * axis + (edge.node >> axis & 1));
  return faces;
}

/// The nodes of a face, counter-clockwise from outside the cube.
constexpr std::array<std::size_t, 4> face_nodes(std::size_t axis, std::size_t side) {
  const std::size_t u = std::size_t{1} << (axis + 1) % 3, v = std::size_t{1} << (axis + 2) % 3;
  const std::size_t base = side << axis;
  if (side == 1) return {base, base | u, base | u | v, base | v};
  return {base, base | v, base | u | v, base | u};
}

/// Lines of the surface on the cube's faces: from edge k to edge next[k]. Around a face, counter-clockwise
/// from outside, a line begins where the boundary enters the inside, and ends where it leaves it. The two
/// faces at an edge go along it in opposite directions, so a line that ends there on one face continues on
/// the other. The lines of a cube are therefore closed.
constexpr std::array<std::uint8_t, 12> lines_of(unsigned inside) {
  constexpr std::uint8_t nothing = 12;
  std::array<std::uint8_t, 12> next{};
  for (std::uint8_t& edge : next) edge = nothing;
  for (std::size_t face = 0; face < 6; ++face) {
    const auto nodes = face_nodes(face / 2, face % 2);
    for (std::size_t k = 0; k < 4; ++k) {
      if ((inside >> nodes[k] & 1) != 0 || (inside >> nodes[(k + 1) % 4] & 1) == 0) continue;
      std::size_t leave = k + 1;
      while ((inside >> nodes[(leave + 1) % 4] & 1) != 0) ++leave;
      next[edge_between(nodes[k], nodes[(k + 1) % 4])] =
          static_cast<std::uint8_t>(edge_between(nodes[leave % 4], nodes[(leave + 1) % 4]));
    }
  }
  return next;
}

/// Divides the polygon corner[first] ... corner[last] into triangles, one of which has the side first - last.
/// Returns whether this is possible without a diagonal within a face.
constexpr bool cut_polygon(const std::array<std::uint8_t, 12>& corner, std::size_t first, std::size_t last,
                           CubeCase& result) {
  if (last - first < 2) return true;
  const auto allowed = [&](std::size_t a, std::size_t b) {
    return b - a == 1 || (faces_of(corner[a]) & faces_of(corner[b])) == 0;
  };
  for (std::size_t middle = first + 1; middle < last; ++middle) {
    if (!allowed(first, middle) || !allowed(middle, last)) continue;
    const std::uint8_t before = result.triangle_count;
    result.triangles[result.triangle_count++] = {corner[first], corner[middle], corner[last]};
    if (cut_polygon(corner, first, middle, result) && cut_polygon(corner, middle, last, result)) return true;
    result.triangle_count = before;
  }
  return false;
}

constexpr CubeCase make_case(unsigned inside) {
  CubeCase result;
  std::array<std::uint8_t, 12> next = lines_of(inside);
  for (std::size_t start = 0; start < 12; ++start) {
    std::array<std::uint8_t, 12> corner{};
    std::size_t count = 0;
    for (auto at = static_cast<std::uint8_t>(start); next[at] != 12;) {
      corner[count++] = at;
      const std::uint8_t to = next[at];
      next[at] = 12;
      at = to;
    }
    if (count > 0) cut_polygon(corner, 0, count - 1, result);
  }
  return result;
}

constexpr std::array<CubeCase, 256> make_cases() {
  std::array<CubeCase, 256> cases;
  for (unsigned inside = 0; inside < 256; ++inside) cases[inside] = make_case(inside);
  return cases;
}

// --- bricks as sets of nodes

constexpr std::uint64_t nodes_where(int axis, int at) {
  std::uint64_t nodes = 0;
  for (int n = 0; n < kernels::brick_nodes; ++n)
    if ((n >> 2 * axis) % 4 == at) nodes |= std::uint64_t{1} << n;
  return nodes;
}

/// Shifts nodes by one along an axis: bit n is the bit of the next node, in the brick or in the `next` brick.
template <int axis>
std::uint64_t shifted(std::uint64_t nodes, std::uint64_t next) {
  constexpr int step = 1 << 2 * axis;
  constexpr std::uint64_t last = nodes_where(axis, brick_side - 1);
  return (nodes >> step & ~last) | (next << 3 * step & last);
}

/// Per corner of a cell: the cells of a brick with that corner inside.
std::array<std::uint64_t, 8> corners_inside(const std::array<std::uint64_t, 8>& bricks) {
  std::array<std::uint64_t, 8> x{}, y{}, z{};
  for (std::size_t b = 0; b < 8; b += 2) x[b] = bricks[b], x[b + 1] = shifted<0>(bricks[b], bricks[b + 1]);
  for (const std::size_t b : {0u, 1u, 4u, 5u}) y[b] = x[b], y[b + 2] = shifted<1>(x[b], x[b + 2]);
  for (std::size_t b = 0; b < 4; ++b) z[b] = y[b], z[b + 4] = shifted<2>(y[b], y[b + 4]);
  return z;
}

std::uint64_t mixed_cells(const std::array<std::uint64_t, 8>& corners) {
  std::uint64_t some = 0, all = ~std::uint64_t{0};
  for (const std::uint64_t corner : corners) some |= corner, all &= corner;
  return some & ~all;
}

unsigned case_of(const std::array<std::uint64_t, 8>& corners, int cell) {
  unsigned inside = 0;
  for (unsigned k = 0; k < 8; ++k) inside |= static_cast<unsigned>(corners[k] >> cell & 1) << k;
  return inside;
}

template <class Function>
void for_bits(std::uint64_t bits, const Function& f) {
  for (; bits != 0; bits &= bits - 1) f(std::countr_zero(bits));
}

std::array<std::uint64_t, 8> insides(const SurfaceField& field, const std::array<std::uint32_t, 8>& bricks) {
  std::array<std::uint64_t, 8> result;
  for (std::size_t b = 0; b < 8; ++b) result[b] = field.inside(bricks[b]);
  return result;
}

/// The points where the edges of a brick cross the surface.
struct CutEdges {
  static constexpr std::size_t capacity = std::size_t{3} * kernels::brick_nodes;

  std::size_t count = 0;
  float start[3][capacity], fraction[capacity];  // first node [m]; position along the edge, in cells
  float low[capacity], high[capacity];           // bounds of the fraction
  std::size_t axis[capacity];
  bool starts_inside[capacity];
  float cell;
  // At the fraction of the last newton_step.
  float at[3][capacity], value[capacity], gradient[3][capacity], shift[3][capacity], crowd[capacity];

  CutEdges(const SurfaceField& field, std::uint32_t brick, const std::array<std::uint32_t, 8>& corners,
           const std::array<std::uint64_t, 3>& edges);
  void newton_step(const SurfaceField& field, std::uint32_t brick);
  Vec3f position(std::size_t k) const;
  Vec3f normal(std::size_t k) const {
    return unit_normal(-Vec3f{gradient[0][k], gradient[1][k], gradient[2][k]});
  }
};

/// Starts where a field that is linear along the edge has the level.
CutEdges::CutEdges(const SurfaceField& field, std::uint32_t brick,
                   const std::array<std::uint32_t, 8>& corners, const std::array<std::uint64_t, 3>& edges)
    : cell(field.cell()) {
  const std::array<float, 3> origin = field.origin(brick);
  for (std::size_t along = 0; along < 3; ++along) {
    for_bits(edges[along], [&](int bit) {
      const auto node = static_cast<std::uint32_t>(bit);
      const bool leaves = (node >> 2 * along & 3) == brick_side - 1;
      const std::uint32_t end = leaves ? node - (3u << 2 * along) : node + (1u << 2 * along);
      const float a = field.value(brick, node);
      const float b = field.value(leaves ? corners[std::size_t{1} << along] : brick, end);
      for (std::size_t c = 0; c < 3; ++c)
        start[c][count] = origin[c] + cell * static_cast<float>(node >> 2 * c & 3);
      axis[count] = along;
      starts_inside[count] = a > field.level();
      fraction[count] = (field.level() - a) / (b - a);
      low[count] = 0, high[count] = 1;
      ++count;
    });
  }
}

/// One step of Newton's method with the field's gradient, within the bounds of the fraction.
void CutEdges::newton_step(const SurfaceField& field, std::uint32_t brick) {
  const std::size_t whole = (count + 15) / 16 * 16;
  for (std::size_t c = 0; c < 3; ++c) {
    for (std::size_t k = 0; k < count; ++k) at[c][k] = start[c][k] + (axis[k] == c ? cell * fraction[k] : 0);
    std::fill(at[c] + count, at[c] + whole, at[c][0]);
  }
  const auto near = field.kernels_near(brick);
  const kernels::FieldPoints points{{at[0], at[1], at[2]},
                                    value,
                                    {gradient[0], gradient[1], gradient[2]},
                                    {shift[0], shift[1], shift[2]},
                                    crowd};
  field.functions().points(field.particle_kernels(), near.data(), near.size(), points, whole);
  for (std::size_t k = 0; k < count; ++k) {
    float& t = fraction[k];
    ((value[k] > field.level()) == starts_inside[k] ? low[k] : high[k]) = t;
    const float next = t + (field.level() - value[k]) / (gradient[axis[k]][k] * cell);
    if (std::isfinite(next)) t = std::clamp(next, low[k], high[k]);
  }
}

/// The vertex. It stays at least a fiftieth of a cell from both nodes, so that triangles keep an area. Then it is moved
/// back by the shift of the centers.
Vec3f CutEdges::position(std::size_t k) const {
  constexpr float least = 0.02f;
  Vec3f x{start[0][k], start[1][k], start[2][k]};
  x[static_cast<int>(axis[k])] += cell * std::clamp(fraction[k], least, 1 - least);
  return x - Vec3f{shift[0][k], shift[1][k], shift[2][k]};
}

template <class Function>
void for_bricks(std::size_t count, Threads& threads, const Function& f) {
  threads.each(count, 64, [&](std::size_t b) { f(static_cast<std::uint32_t>(b)); });
}

}  // namespace

const std::array<CubeCase, 256>& cube_cases() {
  static const std::array<CubeCase, 256> cases = make_cases();
  return cases;
}

void MarchingCubes::extract(const SurfaceField& field, SurfaceMesh& mesh, Threads& threads) {
  find_cuts(field, threads);
  number();
  mesh.positions.resize(vertex_count_);
  mesh.normals.resize(vertex_count_);
  crowd_.resize(vertex_count_);
  mesh.triangles.resize(triangle_count_);
  for_bricks(cuts_.size(), threads, [&](std::uint32_t b) {
    write_vertices(field, b, mesh);
    write_triangles(field, b, mesh);
  });
}

void MarchingCubes::find_cuts(const SurfaceField& field, Threads& threads) {
  const Bricks& bricks = field.bricks();
  cuts_.resize(bricks.size());
  corners_.resize(bricks.size());
  const auto& cases = cube_cases();
  for_bricks(bricks.size(), threads, [&](std::uint32_t b) {
    const Bricks::Coordinates at = bricks.at(b);
    Corner& corner = corners_[b];
    for (unsigned k = 0; k < 8; ++k) {
      const auto step = [&](unsigned axis) { return static_cast<std::int32_t>(k >> axis & 1); };
      corner[k] = k == 0 ? b : bricks.find({at[0] + step(0), at[1] + step(1), at[2] + step(2)});
    }
    const std::array<std::uint64_t, 8> inside = insides(field, corner);
    const std::array<std::uint64_t, 8> nodes = corners_inside(inside);
    Cut& cut = cuts_[b];
    cut.edges = {nodes[0] ^ nodes[1], nodes[0] ^ nodes[2], nodes[0] ^ nodes[4]};
    cut.first_vertex = 0, cut.first_triangle = 0;
    for (const std::uint64_t edges : cut.edges)
      cut.first_vertex += static_cast<std::uint32_t>(std::popcount(edges));
    for_bits(mixed_cells(nodes),
             [&](int cell) { cut.first_triangle += cases[case_of(nodes, cell)].triangle_count; });
  });
}

void MarchingCubes::number() {
  std::uint32_t vertices = 0, triangles = 0;
  for (Cut& cut : cuts_) {
    vertices += std::exchange(cut.first_vertex, vertices);
    triangles += std::exchange(cut.first_triangle, triangles);
  }
  vertex_count_ = vertices, triangle_count_ = triangles;
}

std::uint32_t MarchingCubes::vertex(std::uint32_t brick, std::uint32_t node, std::size_t axis) const {
  const Cut& cut = cuts_[brick];
  std::uint32_t number = cut.first_vertex;
  for (std::size_t a = 0; a < axis; ++a) number += static_cast<std::uint32_t>(std::popcount(cut.edges[a]));
  const std::uint64_t before = (std::uint64_t{1} << node) - 1;
  return number + static_cast<std::uint32_t>(std::popcount(cut.edges[axis] & before));
}

// Two steps of Newton's method bring vertices within a hundredth of a cell of the level.
void MarchingCubes::write_vertices(const SurfaceField& field, std::uint32_t brick, SurfaceMesh& mesh) {
  constexpr int newton_steps = 2;
  const Cut& cut = cuts_[brick];
  if ((cut.edges[0] | cut.edges[1] | cut.edges[2]) == 0) return;
  CutEdges edges(field, brick, corners_[brick], cut.edges);
  for (int step = 0; step < newton_steps; ++step) edges.newton_step(field, brick);
  for (std::size_t k = 0; k < edges.count; ++k) {
    const std::size_t v = cut.first_vertex + k;
    mesh.positions[v] = edges.position(k);
    mesh.normals[v] = edges.normal(k);
    crowd_[v] = edges.crowd[k];
  }
}

void MarchingCubes::write_triangles(const SurfaceField& field, std::uint32_t brick, SurfaceMesh& mesh) const {
  const auto& cases = cube_cases();
  const Corner& corner = corners_[brick];
  const auto nodes = corners_inside(insides(field, corner));
  std::uint32_t next = cuts_[brick].first_triangle;
  for_bits(mixed_cells(nodes), [&](int bit) {
    const auto cell = static_cast<std::uint32_t>(bit);
    const CubeCase& found = cases[case_of(nodes, bit)];
    // The vertex on an edge of the cell, in this brick or in one of its upper neighbors.
    const auto corner_of = [&](std::uint8_t e) {
      const CubeEdge edge = cube_edge(e);
      std::uint32_t node = 0, of = 0;
      for (std::uint32_t axis = 0; axis < 3; ++axis) {
        const auto at = (cell >> 2 * axis & 3) + static_cast<std::uint32_t>(edge.node >> axis & 1);
        node |= (at & 3) << 2 * axis;
        of |= (at >> 2) << axis;
      }
      return vertex(corner[of], node, edge.axis);
    };
    for (std::size_t t = 0; t < found.triangle_count; ++t) {
      const auto& edges = found.triangles[t];
      mesh.triangles[next++] = {corner_of(edges[0]), corner_of(edges[1]), corner_of(edges[2])};
    }
  });
}

}  // namespace souple
