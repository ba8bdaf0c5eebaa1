#include "souple/geometry/builders.h"

#include "souple/error.h"
#include "souple/geometry/adjacency.h"
#include "souple/geometry/circle.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <fmt/core.h>

namespace souple {
namespace {

std::uint32_t index32(std::int64_t i) {
  return static_cast<std::uint32_t>(i);
}

void require_count(const char* builder, const char* what, int value, int minimum) {
  if (value < minimum)
    throw Error(fmt::format("{}: {} is {}, expected at least {}", builder, what, value, minimum));
}

void require_length(const char* builder, const char* what, double value) {
  if (std::isfinite(value) && value > 0) return;
  throw Error(fmt::format("{}: {} is {:g}, expected a positive length in meters", builder, what, value));
}

// `count` is a double, so that products of huge counts do not overflow.
void require_total(const char* builder, double count) {
  if (count <= max_built_vertices) return;
  throw Error(fmt::format("{}: {:.3g} elements are more than the limit of 100 million; use smaller counts",
                          builder, count));
}

// Splits the quad a b / c d (a is adjacent to b and c, winding a, c, b) along a-d or b-c.
void add_quad(std::vector<Triangle>& triangles, std::uint32_t a, std::uint32_t b, std::uint32_t c,
              std::uint32_t d, bool along_ad) {
  if (along_ad) {
    triangles.push_back({a, c, d});
    triangles.push_back({a, d, b});
  } else {
    triangles.push_back({a, c, b});
    triangles.push_back({b, c, d});
  }
}

// The k-th of n evenly spaced positions from -size / 2 to size / 2, exactly symmetric.
double centered(int k, int n, double size) {
  return size * (double(2 * std::int64_t(k) - n) / (2.0 * double(n)));
}

}  // namespace

TriangleMesh grid(int columns, int rows, double size, Diagonals diagonals) {
  require_count("grid", "columns", columns, 2);
  require_count("grid", "rows", rows, 2);
  require_length("grid", "size", size);
  require_total("grid", double(columns) * double(rows) * 2);
  const double depth = size * (double(rows - 1) / double(columns - 1));
  require_length("grid", "depth", depth);
  const double side = std::max(columns, rows) - 1;
  TriangleMesh mesh;
  mesh.positions.reserve(std::size_t(columns) * std::size_t(rows));
  for (int r = 0; r < rows; ++r)
    for (int c = 0; c < columns; ++c) {
      mesh.positions.push_back({centered(c, columns - 1, size), 0.0, centered(r, rows - 1, depth)});
      mesh.uvs.push_back({float(c / side), float(r / side)});
    }
  for (int r = 0; r + 1 < rows; ++r)
    for (int c = 0; c + 1 < columns; ++c) {
      const std::uint32_t a = index32(std::int64_t(r) * columns + c), below = a + index32(columns);
      const bool turned = diagonals == Diagonals::alternating && (r + c) % 2 != 0;
      add_quad(mesh.triangles, a, a + 1, below, below + 1, !turned);
    }
  return mesh;
}

TriangleMesh disk(int rings, int segments, double radius) {
  require_count("disk", "rings", rings, 1);
  require_count("disk", "segments", segments, 3);
  require_length("disk", "radius", radius);
  require_total("disk", double(rings) * double(segments) * 2);
  TriangleMesh mesh;
  mesh.positions.push_back({});
  mesh.uvs.push_back({0.5f, 0.5f});
  for (int ring = 1; ring <= rings; ++ring)
    for (int s = 0; s < segments; ++s) {
      const CirclePoint p = circle_point(s, segments);
      const double part = double(ring) / double(rings), r = radius * part;
      mesh.positions.push_back({r * p.cosine, 0.0, r * p.sine});
      mesh.uvs.push_back({float(0.5 + 0.5 * part * p.cosine), float(0.5 + 0.5 * part * p.sine)});
    }
  const auto at = [&](int ring, int s) {
    return index32(1 + std::int64_t(ring - 1) * segments + s % segments);
  };
  for (int s = 0; s < segments; ++s) mesh.triangles.push_back({0, at(1, s + 1), at(1, s)});
  for (int ring = 1; ring < rings; ++ring)
    for (int s = 0; s < segments; ++s)
      add_quad(mesh.triangles, at(ring, s), at(ring + 1, s), at(ring, s + 1), at(ring + 1, s + 1),
               (ring + s) % 2 == 0);
  return mesh;
}

namespace {

TriangleMesh icosahedron() {
  const double f = (1 + std::sqrt(5.0)) / 2;  // golden ratio
  TriangleMesh mesh;
  mesh.positions = {{-1, f, 0},  {1, f, 0},  {-1, -f, 0}, {1, -f, 0}, {0, -1, f},  {0, 1, f},
                    {0, -1, -f}, {0, 1, -f}, {f, 0, -1},  {f, 0, 1},  {-f, 0, -1}, {-f, 0, 1}};
  mesh.triangles = {{0, 11, 5},  {0, 5, 1},  {0, 1, 7},  {0, 7, 10}, {0, 10, 11}, {1, 5, 9}, {5, 11, 4},
                    {11, 10, 2}, {10, 7, 6}, {7, 1, 8},  {3, 9, 4},  {3, 4, 2},   {3, 2, 6}, {3, 6, 8},
                    {3, 8, 9},   {4, 9, 5},  {2, 4, 11}, {6, 2, 10}, {8, 6, 7},   {9, 8, 1}};
  for (Vec3d& p : mesh.positions) p = normalized(p);
  return mesh;
}

// Splits each triangle into four at the midpoints of its sides, projected to the unit sphere.
TriangleMesh subdivided(const TriangleMesh& coarse) {
  const TriangleEdges edges = triangle_edges(coarse.triangles);
  TriangleMesh fine;
  fine.positions = coarse.positions;
  const std::uint32_t first = index32(std::int64_t(coarse.positions.size()));
  for (const Edge& e : edges.edges)
    fine.positions.push_back(normalized(coarse.positions[e[0]] + coarse.positions[e[1]]));
  fine.triangles.reserve(coarse.triangles.size() * 4);
  for (std::size_t t = 0; t < coarse.triangles.size(); ++t) {
    const auto [a, b, c] = coarse.triangles[t];
    const auto& side = edges.of_triangle[t];
    const std::uint32_t ab = first + side[0], bc = first + side[1], ca = first + side[2];
    for (const Triangle& part :
         {Triangle{a, ab, ca}, Triangle{b, bc, ab}, Triangle{c, ca, bc}, Triangle{ab, bc, ca}})
      fine.triangles.push_back(part);
  }
  return fine;
}

// 20 * 4^subdivisions, of any number.
double subdivided_faces(int subdivisions) {
  return std::ldexp(20.0, 2 * std::min(subdivisions, 500));
}

}  // namespace

TriangleMesh sphere(int subdivisions, double radius) {
  require_count("sphere", "subdivisions", subdivisions, 0);
  require_length("sphere", "radius", radius);
  require_total("sphere", subdivided_faces(subdivisions));
  TriangleMesh mesh = icosahedron();
  for (int i = 0; i < subdivisions; ++i) mesh = subdivided(mesh);
  for (Vec3d& p : mesh.positions) p *= radius;
  return mesh;
}

namespace {

// The lattice points (i, j, k) on the surface of a box of n cells, numbered layer by layer. The first and the last
// layer are full, the others are rims.
struct BoxShell {
  std::array<int, 3> n;

  std::int64_t full() const { return (std::int64_t(n[0]) + 1) * (std::int64_t(n[1]) + 1); }
  std::int64_t rim() const { return 2 * (std::int64_t(n[0]) + n[1]); }

  std::uint32_t index(int i, int j, int k) const {
    const std::int64_t row = std::int64_t(n[0]) + 1;
    if (k == 0) return index32(j * row + i);
    const std::int64_t layer = full() + (k - 1) * rim();
    if (k == n[2]) return index32(layer + j * row + i);
    if (j == 0) return index32(layer + i);
    if (j == n[1]) return index32(layer + row + i);
    return index32(layer + 2 * row + (i == 0 ? j - 1 : n[1] - 1 + j - 1));
  }
};

// The two faces of the box across `axis`, at coordinates 0 and n.
void add_box_faces(std::vector<Triangle>& triangles, const BoxShell& shell, std::size_t axis) {
  const std::size_t u = (axis + 1) % 3, v = (axis + 2) % 3;  // right-handed: u x v = axis
  const auto at = [&](int level, int iu, int iv) {
    std::array<int, 3> p{};
    p[axis] = level;
    p[u] = iu;
    p[v] = iv;
    return shell.index(p[0], p[1], p[2]);
  };
  for (int iv = 0; iv < shell.n[v]; ++iv)
    for (int iu = 0; iu < shell.n[u]; ++iu) {
      const bool cut = (iu + iv) % 2 == 0;
      const int top = shell.n[axis];
      add_quad(triangles, at(0, iu, iv), at(0, iu + 1, iv), at(0, iu, iv + 1), at(0, iu + 1, iv + 1), cut);
      add_quad(triangles, at(top, iu, iv), at(top, iu, iv + 1), at(top, iu + 1, iv), at(top, iu + 1, iv + 1),
               cut);
    }
}

}  // namespace

TriangleMesh box(const Vec3d& size, const std::array<int, 3>& divisions) {
  const char* axis_name[3] = {"size x", "size y", "size z"};
  double faces = 0;
  for (int i = 0; i < 3; ++i) {
    require_length("box", axis_name[i], size[i]);
    require_count("box", "divisions", divisions[std::size_t(i)], 1);
    faces += 4.0 * double(divisions[std::size_t(i)]) * double(divisions[std::size_t((i + 1) % 3)]);
  }
  require_total("box", faces);
  const BoxShell shell{divisions};
  TriangleMesh mesh;
  const auto [nx, ny, nz] = divisions;
  for (int k = 0; k <= nz; ++k) {
    const bool full = k == 0 || k == nz;
    // In the order of BoxShell::index: of a rim, the sides j = 0 and j = ny, then i = 0 and i = nx.
    const auto add = [&, k](int i, int j) {
      mesh.positions.push_back({centered(i, divisions[0], size.x), centered(j, divisions[1], size.y),
                                centered(k, divisions[2], size.z)});
    };
    for (int j = 0; j <= ny; j += full ? 1 : ny)
      for (int i = 0; i <= nx; ++i) add(i, j);
    if (full) continue;
    for (int i = 0; i <= nx; i += nx)
      for (int j = 1; j < ny; ++j) add(i, j);
  }
  for (std::size_t axis = 0; axis < 3; ++axis) add_box_faces(mesh.triangles, shell, axis);
  return mesh;
}

TriangleMesh box(const Vec3d& size, int divisions) {
  return box(size, std::array<int, 3>{divisions, divisions, divisions});
}

TriangleMesh torus(double major_radius, double minor_radius, int major_segments, int minor_segments) {
  require_length("torus", "major_radius", major_radius);
  require_length("torus", "minor_radius", minor_radius);
  if (!(minor_radius < major_radius))
    throw Error(
        "torus: minor_radius must be smaller than major_radius, or the tube meets itself in the middle");
  require_count("torus", "major_segments", major_segments, 3);
  require_count("torus", "minor_segments", minor_segments, 3);
  require_total("torus", double(major_segments) * double(minor_segments) * 2);
  TriangleMesh mesh;
  for (int i = 0; i < major_segments; ++i)
    for (int j = 0; j < minor_segments; ++j) {
      const CirclePoint around = circle_point(i, major_segments), tube = circle_point(j, minor_segments);
      const double r = major_radius + minor_radius * tube.cosine;
      mesh.positions.push_back({r * around.cosine, minor_radius * tube.sine, r * around.sine});
    }
  const auto at = [&](int i, int j) {
    return index32(std::int64_t(i % major_segments) * minor_segments + j % minor_segments);
  };
  for (int i = 0; i < major_segments; ++i)
    for (int j = 0; j < minor_segments; ++j)
      add_quad(mesh.triangles, at(i, j), at(i + 1, j), at(i, j + 1), at(i + 1, j + 1), (i + j) % 2 == 0);
  return mesh;
}

namespace {

// A point of a profile that is revolved about the Y axis.
struct ProfilePoint {
  double radius, height;
};

// Revolves a profile from the bottom pole (first) to the top pole (last) about Y.
TriangleMesh revolve(const std::vector<ProfilePoint>& outline, int segments) {
  TriangleMesh mesh;
  const int rings = int(outline.size()) - 2;
  mesh.positions.push_back({0, outline.front().height, 0});
  for (int ring = 1; ring <= rings; ++ring)
    for (int s = 0; s < segments; ++s) {
      const CirclePoint p = circle_point(s, segments);
      const ProfilePoint& o = outline[std::size_t(ring)];
      mesh.positions.push_back({o.radius * p.cosine, o.height, o.radius * p.sine});
    }
  mesh.positions.push_back({0, outline.back().height, 0});
  const auto at = [&](int ring, int s) {
    return index32(1 + std::int64_t(ring - 1) * segments + s % segments);
  };
  const std::uint32_t top = index32(std::int64_t(mesh.positions.size()) - 1);
  for (int s = 0; s < segments; ++s) mesh.triangles.push_back({0, at(1, s), at(1, s + 1)});
  for (int ring = 1; ring < rings; ++ring)
    for (int s = 0; s < segments; ++s)
      add_quad(mesh.triangles, at(ring, s), at(ring, s + 1), at(ring + 1, s), at(ring + 1, s + 1),
               (ring + s) % 2 == 0);
  for (int s = 0; s < segments; ++s) mesh.triangles.push_back({top, at(rings, s + 1), at(rings, s)});
  return mesh;
}

}  // namespace

TriangleMesh capsule(double radius, double length, int segments, int rings, int divisions) {
  require_length("capsule", "radius", radius);
  require_length("capsule", "length", length);
  require_count("capsule", "segments", segments, 3);
  require_count("capsule", "rings", rings, 1);
  require_count("capsule", "divisions", divisions, 1);
  require_total("capsule", (2.0 * double(rings) + double(divisions)) * double(segments) * 2);
  std::vector<ProfilePoint> outline;
  const auto add_arc = [&](int k, double side) {  // k rings from the pole
    const CirclePoint p = circle_point(rings - k, 4 * std::int64_t(rings));
    outline.push_back({radius * p.cosine, side * (length / 2 + radius * p.sine)});
  };
  for (int k = 0; k <= rings; ++k) add_arc(k, -1);
  for (int k = 1; k < divisions; ++k) outline.push_back({radius, centered(k, divisions, length)});
  for (int k = rings; k >= 0; --k) add_arc(k, 1);
  return revolve(outline, segments);
}

TriangleMesh cylinder(double radius, double height, int segments, int divisions, int cap_rings) {
  require_length("cylinder", "radius", radius);
  require_length("cylinder", "height", height);
  require_count("cylinder", "segments", segments, 3);
  require_count("cylinder", "divisions", divisions, 1);
  require_count("cylinder", "cap_rings", cap_rings, 1);
  require_total("cylinder", (2.0 * double(cap_rings) + double(divisions)) * double(segments) * 2);
  std::vector<ProfilePoint> outline;
  const auto ring_radius = [&](int k) { return radius * (double(k) / double(cap_rings)); };
  for (int k = 0; k <= cap_rings; ++k) outline.push_back({ring_radius(k), -height / 2});
  for (int k = 1; k < divisions; ++k) outline.push_back({radius, centered(k, divisions, height)});
  for (int k = cap_rings; k >= 0; --k) outline.push_back({ring_radius(k), height / 2});
  return revolve(outline, segments);
}

TetMesh tet_bar(int nx, int ny, int nz, const Vec3d& size) {
  require_count("tet_bar", "nx", nx, 1);
  require_count("tet_bar", "ny", ny, 1);
  require_count("tet_bar", "nz", nz, 1);
  require_length("tet_bar", "size x", size.x);
  require_length("tet_bar", "size y", size.y);
  require_length("tet_bar", "size z", size.z);
  require_total("tet_bar", 5.0 * double(nx) * double(ny) * double(nz));
  TetMesh mesh;
  for (int k = 0; k <= nz; ++k)
    for (int j = 0; j <= ny; ++j)
      for (int i = 0; i <= nx; ++i)
        mesh.positions.push_back({centered(i, nx, size.x), centered(j, ny, size.y), centered(k, nz, size.z)});
  // Corners of a cell are numbered x + 2 y + 4 z. A cell has four corner tets and a central one. The second
  // split mirrors the first in x, so that diagonals of neighboring cells coincide on their common face.
  constexpr int cut[2][5][4] = {{{0, 1, 2, 4}, {3, 2, 1, 7}, {5, 4, 7, 1}, {6, 7, 4, 2}, {1, 2, 4, 7}},
                                {{1, 3, 0, 5}, {2, 0, 3, 6}, {4, 6, 5, 0}, {7, 5, 6, 3}, {0, 5, 3, 6}}};
  const auto at = [&](int i, int j, int k) {
    return index32((std::int64_t(k) * (ny + 1) + j) * (nx + 1) + i);
  };
  for (int k = 0; k < nz; ++k)
    for (int j = 0; j < ny; ++j)
      for (int i = 0; i < nx; ++i)
        for (const auto& t : cut[(i + j + k) % 2]) {
          Tet tet{};
          for (std::size_t c = 0; c < 4; ++c)
            tet[c] = at(i + (t[c] & 1), j + (t[c] >> 1 & 1), k + (t[c] >> 2));
          mesh.tets.push_back(tet);
        }
  return mesh;
}

TetMesh tet_ball(int subdivisions, int layers, double radius) {
  require_count("tet_ball", "subdivisions", subdivisions, 0);
  require_count("tet_ball", "layers", layers, 1);
  require_length("tet_ball", "radius", radius);
  require_total("tet_ball", subdivided_faces(subdivisions) * (3 * double(layers) - 2));
  const TriangleMesh skin = sphere(subdivisions, 1);
  const std::uint32_t shell = index32(std::int64_t(skin.positions.size()));
  TetMesh mesh;
  for (int layer = layers; layer > 0; --layer)
    for (const Vec3d& p : skin.positions) mesh.positions.push_back(p * (radius * layer / layers));
  mesh.positions.push_back({});
  const std::uint32_t middle = index32(std::int64_t(mesh.positions.size())) - 1;
  for (Triangle t : skin.triangles) {
    for (int layer = 1; layer < layers; ++layer) {
      const std::uint32_t out = index32(layer - 1) * shell, in = out + shell;
      // Splits a prism into three tets. The diagonal of each side joins the outer end of the lower vertex and
      // the inner end of the higher one, so that neighbors match. Rotated so that the lowest vertex is first.
      while (t[0] > t[1] || t[0] > t[2]) t = {t[1], t[2], t[0]};
      const auto [a, b, c] = t;
      mesh.tets.push_back({in + a, in + b, in + c, out + a});
      if (b < c) {
        mesh.tets.push_back({out + a, in + b, in + c, out + b});
        mesh.tets.push_back({out + a, out + b, in + c, out + c});
      } else {
        mesh.tets.push_back({out + a, in + b, in + c, out + c});
        mesh.tets.push_back({out + a, out + b, in + b, out + c});
      }
    }
    const std::uint32_t out = index32(layers - 1) * shell;
    mesh.tets.push_back({middle, out + t[0], out + t[1], out + t[2]});
  }
  return mesh;
}

}  // namespace souple
