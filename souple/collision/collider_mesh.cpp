#include "souple/collision/collider_mesh.h"

#include "souple/geometry/builders.h"
#include "souple/geometry/creased_surface.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

namespace souple {
namespace {

/// Index of the side of a box (0 to 5) that a normal belongs to.
int side_of(const Vec3d& normal) {
  int axis = 0;
  for (int k = 1; k < 3; ++k)
    if (std::abs(normal[k]) > std::abs(normal[axis])) axis = k;
  return 2 * axis + (normal[axis] < 0 ? 1 : 0);
}

Vec3d face_normal(const TriangleMesh& mesh, const Triangle& t) {
  const Vec3d& a = mesh.positions[t[0]];
  return normalized(cross(mesh.positions[t[1]] - a, mesh.positions[t[2]] - a));
}

/// Copies a mesh and moves it to `center`. `crease(face normal)` returns the number of a triangle's smooth
/// patch; vertices between patches are doubled. `normal(vertex, face normal)` returns the normal at a vertex.
template <class Crease, class Normal>
ColliderMesh creased(const TriangleMesh& mesh, const Vec3f& center, const Crease& crease,
                     const Normal& normal) {
  ColliderMesh result;
  std::map<std::pair<std::uint32_t, int>, std::uint32_t> copies;
  for (const Triangle& triangle : mesh.triangles) {
    const Vec3d face = face_normal(mesh, triangle);
    Triangle corners{};
    for (std::size_t k = 0; k < 3; ++k) {
      const auto next = static_cast<std::uint32_t>(result.positions.size());
      const auto [copy, is_new] = copies.try_emplace({triangle[k], crease(face)}, next);
      corners[k] = copy->second;
      if (!is_new) continue;
      const Vec3d& x = mesh.positions[triangle[k]];
      result.positions.push_back(Vec3f(x + Vec3d(center)));
      result.normals.push_back(Vec3f(normal(x, face)));
    }
    result.triangles.push_back(corners);
  }
  return result;
}

const auto no_crease = [](const Vec3d&) { return 0; };

struct MeshOf {
  Vec3d center;
  double extent;

  ColliderMesh operator()(const Plane& plane) const {
    const Vec3d n(plane.normal);
    const double size = length(n);
    const Vec3d unit = n / size;
    const Vec3d middle = center + unit * (static_cast<double>(plane.offset) / size - dot(unit, center));
    const Vec3d aside = normalized(cross(unit, std::abs(unit.y) < 0.9 ? Vec3d{0, 1, 0} : Vec3d{0, 0, 1}));
    const Vec3d u = aside * extent, v = cross(unit, aside) * extent;
    ColliderMesh result;
    for (const Vec3d& corner : {middle - u - v, middle + u - v, middle + u + v, middle - u + v}) {
      result.positions.push_back(Vec3f(corner));
      result.normals.push_back(Vec3f(unit));
    }
    result.triangles = {{0, 1, 2}, {0, 2, 3}};
    return result;
  }

  ColliderMesh operator()(const Sphere& ball) const {
    return creased(sphere(4, static_cast<double>(ball.radius)), ball.center, no_crease,
                   [](const Vec3d& x, const Vec3d&) { return normalized(x); });
  }

  ColliderMesh operator()(const Box& solid) const {
    return creased(box(Vec3d(solid.half_extents) * 2.0), solid.center, side_of,
                   [](const Vec3d&, const Vec3d& face) { return face; });
  }

  ColliderMesh operator()(const Capsule& solid) const {
    if (!(solid.half_height > 0)) return (*this)(Sphere{solid.center, solid.radius});
    const auto half = static_cast<double>(solid.half_height);
    return creased(capsule(static_cast<double>(solid.radius), 2 * half, 48, 12), solid.center, no_crease,
                   [half](const Vec3d& x, const Vec3d&) {
                     return normalized(Vec3d{x.x, x.y - std::clamp(x.y, -half, half), x.z});
                   });
  }

  ColliderMesh operator()(const Cylinder& solid) const {
    const auto is_cap = [](const Vec3d& face) { return std::abs(face.y) > 0.5; };
    return creased(
        cylinder(static_cast<double>(solid.radius), 2 * static_cast<double>(solid.half_height), 64),
        solid.center, [&](const Vec3d& face) { return is_cap(face) ? side_of(face) : 0; },
        [&](const Vec3d& x, const Vec3d& face) {
          return is_cap(face) ? face : normalized(Vec3d{x.x, 0, x.z});
        });
  }

  /// The field's mesh, with its sharp edges.
  ColliderMesh operator()(const SignedDistanceField& field) const {
    CreasedSurface surface(field.positions(), field.triangles());
    std::vector<Vec3f> positions;
    for (const Vec3d& x : field.positions()) positions.push_back(Vec3f(x));
    surface.update(positions);
    return {{surface.positions().begin(), surface.positions().end()},
            {surface.normals().begin(), surface.normals().end()},
            {surface.triangles().begin(), surface.triangles().end()}};
  }
};

}  // namespace

ColliderMesh collider_mesh(const Shape& shape, const Vec3d& center, double extent) {
  return std::visit(MeshOf{center, extent}, shape);
}

}  // namespace souple
