#include "souple/souple.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

namespace souple {
namespace {

// All kinds of contacts. A cloth folds over itself on a rotating ring, with a soft body and grains on it. A rope coils
// on a table, and a lattice body lies between them.
World crowded_world(int threads) {
  World world({.threads = threads});
  const auto above = [](double x, double y, double z) {
    ObjectOptions options{.transform = {.translation = {x, y, z}}};
    options.self_collision = SelfCollision::surfaces;
    return options;
  };
  const auto turning = ColliderMotion::callback([](double t) {
    return Transform{.rotation = Quatd::from_axis_angle({0, 1, 0}, 2 * t)};
  });
  world.add_obstacle(torus(0.25, 0.08, 24, 12), {.thickness = 0.01f}, {.pose = turning});
  world.add_cloth(grid(20, 20, 0.9), {.thickness = 0.012f}, above(0.05, 0.1, 0));
  world.add_cloth(grid(10, 10, 0.4), {.thickness = 0.01f}, above(-0.1, 0.12, 0.1));
  world.add_soft_body(tet_ball(1, 2, 0.08), {.thickness = 0.01f}, above(0.1, 0.2, 0));
  world.add_soft_body(tet_bar(3, 3, 3, {0.12, 0.12, 0.12}), {.thickness = 0.01f}, above(-0.12, 0.2, 0.05));
  world.add_soft_body(box({0.1, 0.1, 0.1}), {.model = SoftBodyModel::shape_matching}, {.cells = 60},
                      above(0, 0.2, -0.15));
  std::vector<Vec3d> line, centers;
  for (int k = 0; k <= 24; ++k) {
    const double angle = 2 * pi * k / 8;
    line.push_back({0.06 * std::cos(angle), 0.12 + 0.015 * k, 0.25 + 0.06 * std::sin(angle)});
  }
  world.add_rope(line, 72, {.radius = 0.006f}, above(0, 0, 0));
  for (int x = 0; x < 5; ++x)
    for (int y = 0; y < 5; ++y)
      for (int z = 0; z < 5; ++z) centers.push_back({0.025 * x + 1e-3 * y, 0.025 * y, 0.025 * z + 1e-3 * x});
  world.add_grains(centers, {.radius = 0.01f}, above(-0.2, 0.12, -0.25));
  world.add_collider(Plane{.offset = -0.15f});
  return world;
}

TEST(CollisionThreads, ResultsDoNotDependOnThem) {
  std::vector<std::uint64_t> alone;
  for (const int threads : {1, 2, 8}) {
    World world = crowded_world(threads);
    std::vector<std::uint64_t> hashes;
    std::size_t contacts = 0;
    for (int frame = 0; frame < 10; ++frame) {
      const StepReport& report = world.step(1.0 / 60);
      ASSERT_TRUE(report.ok()) << report.message;
      contacts = std::max(contacts, report.contacts);
      hashes.push_back(world.hash());
    }
    EXPECT_GT(contacts, 200u);
    if (threads == 1) alone = hashes;
    EXPECT_EQ(hashes, alone) << threads << " threads";
  }
}

}  // namespace
}  // namespace souple
