#pragma once

#include "benchmarks/elastic_forces.h"
#include "souple/geometry/builders.h"
#include "souple/world/world.h"

#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

// Two scenes, as forces and as constraints of a world: the same mesh, masses, energies and start.

namespace souple::benchmarks {

/// Cotton of 1 m and n x n vertices without bending stiffness, hung by its upper row. It starts to swing with `spin`
/// rad/s about that row.
struct ClothScene {
  int n = 30;
  double spin = 0;
  float stiffness = 4000;  ///< Y [N/m]; cotton: 4000
  float drag = 0;          ///< 1/s

  TriangleMesh mesh() const {
    TriangleMesh mesh = grid(n, n, 1);
    for (Vec3d& x : mesh.positions) x = {x.x, -x.z - 0.5, 0};
    return mesh;
  }
  ClothMaterial material() const {
    ClothMaterial cotton = material::cotton;
    cotton.membrane_stiffness = stiffness;
    cotton.bending = BendingModel::none;
    return cotton;
  }
  /// The vertices that are farthest from the pinned ones.
  bool is_end(const Vec3d& rest) const { return rest.y < -1 + 1e-6; }
  bool is_pinned(const Vec3d& rest) const { return rest.y > -1e-6; }
  Vec3f velocity(const Vec3d& rest) const { return {0, 0, static_cast<float>(-rest.y * spin)}; }
  ObjectId add(World& world) const { return world.add_cloth(mesh(), material()); }
};

/// A bar of 1 m x 0.2 m x 0.2 m with 25 n^3 tets, straight at the start. One end is fixed, or hinged at its
/// upper edge.
struct BarScene {
  int n = 4;                   ///< cells across
  float young_modulus = 2e6f;  ///< Pa
  bool hinged = false;
  float drag = 0;  ///< 1/s

  TetMesh mesh() const { return tet_bar(5 * n, n, n, {1, 0.2, 0.2}); }
  SoftBodyMaterial material() const { return {.young_modulus = young_modulus, .poisson_ratio = 0.4f}; }
  bool is_end(const Vec3d& rest) const { return rest.x > 0.5 - 1e-6; }
  bool is_pinned(const Vec3d& rest) const { return rest.x < -0.5 + 1e-6 && (!hinged || rest.y > 0.1 - 1e-6); }
  Vec3f velocity(const Vec3d&) const { return {}; }
  ObjectId add(World& world) const { return world.add_soft_body(mesh(), material()); }
};

template <class Scene>
std::vector<std::uint32_t> pinned(const Scene& scene) {
  std::vector<std::uint32_t> result;
  const auto mesh = scene.mesh();
  for (std::uint32_t i = 0; i < mesh.positions.size(); ++i)
    if (scene.is_pinned(mesh.positions[i])) result.push_back(i);
  return result;
}

template <class Scene>
void start(const Scene& scene, ElasticModel& model) {
  model.pin(pinned(scene));
  model.drag = static_cast<double>(scene.drag);
  for (std::size_t i = 0; i < model.x.size(); ++i) model.v[i] = Vec3d(scene.velocity(model.x[i]));
}

/// Adds the scene to a world with these settings.
template <class Scene>
ObjectId start(const Scene& scene, World& world) {
  const ObjectId object = scene.add(world);
  std::vector<Vec3f> velocity;
  for (const Vec3d& x : scene.mesh().positions) velocity.push_back(scene.velocity(x));
  world.set_velocities(object, velocity);
  world.pin(object, vertices(pinned(scene)));
  return object;
}

/// Mean height of the end, relative to the start [m].
template <class Scene, class Positions>
double end_height(const Scene& scene, const Positions& x) {
  const auto mesh = scene.mesh();
  double sum = 0, count = 0;
  for (std::size_t i = 0; i < mesh.positions.size(); ++i)
    if (scene.is_end(mesh.positions[i])) sum += static_cast<double>(x[i].y) - mesh.positions[i].y, ++count;
  return sum / count;
}

}  // namespace souple::benchmarks
