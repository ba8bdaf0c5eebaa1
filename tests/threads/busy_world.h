#pragma once

#include "souple/solver/custom_constraint.h"
#include "souple/souple.h"

#include <cmath>
#include <memory>
#include <vector>

namespace souple::test {

/// Custom constraints that may run concurrently: each keeps one vertex of an object above a height.
inline std::unique_ptr<Projector> floor_of(const World& world, ObjectId object, float height) {
  auto projector = std::make_unique<CustomProjector>();
  for (std::uint32_t vertex = 0; vertex < world.positions(object).size(); ++vertex) {
    auto constraint =
        std::make_shared<CallbackConstraint>(std::vector<std::uint32_t>{world.particle(object, vertex)},
                                             [height](std::span<const Vec3f> x, std::span<Vec3f> gradient) {
                                               gradient[0] = {0, 1, 0};
                                               return x[0].y - height;
                                             });
    constraint->sense = Sense::non_negative;
    constraint->concurrent = true;
    projector->add(std::move(constraint));
  }
  return projector;
}

/// A cloth falls on a rotating ball, and grains and a stiff box fall on the cloth. Beside them a soft body, a balloon
/// and a second box fall on the floor. Every projector kind has enough work for several threads.
inline World busy_world(Settings settings = {}) {
  settings.substeps = 5;
  settings.wind.velocity = {1, 0, 0};
  World world(settings);
  const ObjectId cloth = world.add_cloth(grid(56, 56, 1.0), {.bending = BendingModel::dihedral},
                                         {.transform = {{0, 0.52, 0}, {}, 1}});
  world.pin(cloth, vertices({0, 55}));
  std::vector<Vec3d> centers;
  for (int y = 0; y < 5; ++y)
    for (int k = 0; k < 400; ++k)
      centers.push_back({0.0203 * (k % 20 - 10) + 1e-4 * y, 0.535 + 0.0203 * y, 0.0203 * (k / 20 - 10)});
  world.add_grains(centers);
  world.add_soft_body(box({0.2, 0.2, 0.2}), {.model = SoftBodyModel::shape_matching}, {.cells = 200},
                      {.transform = {{0, 0.8, 0}, {}, 1}, .angular_velocity = {1, 2, 3}});
  world.add_soft_body(box({0.2, 0.2, 0.2}), {.model = SoftBodyModel::shape_matching}, {.cells = 200},
                      {.transform = {{1.5, 0.2, 0}, {}, 1}});
  world.add_soft_body(tet_bar(6, 4, 4, {0.3, 0.2, 0.2}), {}, {.transform = {{1, 0.2, 0}, {}, 1}});
  const ObjectId balloon = world.add_cloth(sphere(2, 0.2), {}, {.transform = {{-1, 0.3, 0}, {}, 1}});
  world.set_pressure(balloon, 200);
  world.set_enclosed_volume(balloon, 1.1f, 1e-7f);
  world.add_projector(floor_of(world, balloon, 0.05f));
  world.add_collider(Plane{});
  world.add_collider(Sphere{.radius = 0.5f}, {.motion = ColliderMotion::callback([](double t) {
                                                const double a = 0.5 * t;
                                                return Transform{{}, {0, std::sin(a), 0, std::cos(a)}, 1};
                                              })});
  return world;
}

}  // namespace souple::test
