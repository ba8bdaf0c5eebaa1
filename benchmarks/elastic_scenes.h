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
  int n;
  double spin;

  TriangleMesh mesh() const {
    TriangleMesh mesh = grid(n, n, 1);
    for (Vec3d& x : mesh.positions) x = {x.x, -x.z - 0.5, 0};
    return mesh;
  }
  ClothMaterial material() const {
    ClothMaterial cotton = material::cotton;
    cotton.bending = BendingModel::none;
    return cotton;
  }
  bool is_pinned(const Vec3d& rest) const { return rest.y > -1e-6; }
  Vec3f velocity(const Vec3d& rest) const { return {0, 0, static_cast<float>(-rest.y * spin)}; }
  ObjectId add(World& world) const { return world.add_cloth(mesh(), material()); }
};

/// A bar of 1 m x 0.2 m x 0.2 m with 25 n^3 tets, straight at the start. One end is fixed.
struct BarScene {
  int n;  ///< cells across

  TetMesh mesh() const { return tet_bar(5 * n, n, n, {1, 0.2, 0.2}); }
  SoftBodyMaterial material() const { return {.young_modulus = 2e6f, .poisson_ratio = 0.4f}; }
  bool is_pinned(const Vec3d& rest) const { return rest.x < -0.5 + 1e-6; }
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

}  // namespace souple::benchmarks
