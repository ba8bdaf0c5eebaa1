#pragma once

#include "souple/broad_phase/near_pairs.h"
#include "souple/geometry/builders.h"
#include "tests/collision/random.h"

#include <functional>
#include <vector>

namespace souple::test {

/// A scene for searches of near pairs: particles, each with a box, and elements of these particles.
struct SurfaceScene {
  SurfaceElements elements;
  std::vector<Bounds> boxes;
  std::vector<Vec4f> position_w;
  std::uint32_t objects = 0;
  ObjectPairs compared;

  std::uint32_t add_particle(const Vec3d& x, double half_size, float inverse_mass = 1) {
    const Vec3f at(x), half{float(half_size), float(half_size), float(half_size)};
    boxes.push_back({at - half, at + half});
    position_w.push_back({at.x, at.y, at.z, inverse_mass});
    return static_cast<std::uint32_t>(boxes.size()) - 1;
  }
  std::uint32_t size() const { return static_cast<std::uint32_t>(boxes.size()); }

  /// A grid with its vertices at shape(x, z), where x and z are those of the flat grid.
  void add_cloth(int columns, double width, double half_size,
                 const std::function<Vec3d(double, double)>& shape) {
    const TriangleMesh mesh = grid(columns, columns, width);
    const std::uint32_t first = size();
    for (const Vec3d& x : mesh.positions) add_particle(shape(x.x, x.z), half_size);
    elements.add_triangles(mesh.triangles, first, objects++);
  }
  /// Triangles at random positions in a cube, with sides of about `length`.
  void add_random_triangles(int triangles, double cube, double length, double half_size, Random& random) {
    const std::uint32_t first = size();
    std::vector<Triangle> list;
    for (int t = 0; t < triangles; ++t) {
      const Vec3d middle = random.point(-cube, cube);
      const std::uint32_t i = size() - first;
      for (int k = 0; k < 3; ++k) add_particle(middle + random.point(-length, length), half_size);
      list.push_back({i, i + 1, i + 2});
    }
    elements.add_triangles(list, first, objects++);
  }
  void add_rope(int count, const Vec3d& from, const Vec3d& to, double half_size) {
    const std::uint32_t first = size();
    std::vector<Edge> edges;
    for (int i = 0; i < count; ++i) {
      add_particle(from + (to - from) * (double(i) / (count - 1)), half_size);
      if (i > 0) edges.push_back({static_cast<std::uint32_t>(i) - 1, static_cast<std::uint32_t>(i)});
    }
    elements.add_edges(edges, first, objects++);
  }
  void add_grains(int count, double cube, double half_size, Random& random) {
    const std::uint32_t first = size();
    for (int i = 0; i < count; ++i) add_particle(random.point(-cube, cube), half_size);
    elements.add_particles(first, size(), objects++);
  }
  void move(const Vec3d& by) {
    for (Bounds& box : boxes) box = {Vec3f(Vec3d(box.lo) + by), Vec3f(Vec3d(box.hi) + by)};
  }
  void all_collide() {
    for (std::uint32_t a = 0; a < objects; ++a)
      for (std::uint32_t b = 0; b <= a; ++b) compared.add(a, b);
  }
};

}  // namespace souple::test
