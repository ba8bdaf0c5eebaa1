#include "souple/geometry/adjacency.h"
#include "souple/geometry/builders.h"
#include "souple/world/world.h"
#include "tests/collision/random.h"
#include "tests/collision/segment_triangle/every_test.h"
#include "tests/count_allocations.h"

#include <algorithm>
#include <vector>

// Detection::discrete: paths x -> p against triangles, by Settings::segment_test.

namespace souple::test::test_segment_triangle_discrete {

constexpr double dt = 1.0 / 60;

TriangleMesh ball_at(const Vec3d& center) {
  TriangleMesh mesh = sphere(3, 1);
  for (Vec3d& x : mesh.positions) x = Vec3d(Vec3f(x + center));  // as the world has them
  return mesh;
}

std::vector<Vec3d> centroids(const TriangleMesh& mesh) {
  std::vector<Vec3d> result;
  for (const Triangle& t : mesh.triangles)
    result.push_back((mesh.positions[t[0]] + mesh.positions[t[1]] + mesh.positions[t[2]]) / 3.0);
  return result;
}

std::vector<Vec3d> corners_and_edges(const TriangleMesh& mesh) {
  std::vector<Vec3d> result = mesh.positions;
  for (const Edge& edge : unique_edges(mesh.triangles))
    result.push_back((mesh.positions[edge[0]] + mesh.positions[edge[1]]) * 0.5);
  return result;
}

/// Number of grains that leave the ball, of those shot at the targets from nearby within it, in one substep.
int shots_through(const Settings& settings, const TriangleMesh& ball, const Vec3d& center,
                  const std::vector<Vec3d>& targets) {
  World world(settings);
  world.add_obstacle(ball, {.thickness = 1e-4f});
  Random random(1);
  std::vector<Vec3d> start;
  std::vector<Vec3f> velocity;
  for (const Vec3d& target : targets) {
    start.push_back(center + (target - center) * 0.85 + random.point(-0.05, 0.05));
    velocity.push_back((Vec3f(target) - Vec3f(start.back())) * static_cast<float>(2 / dt));
  }
  const ObjectId grains = world.add_grains(start, {.radius = 1e-4f}, {.name = "grains"});
  world.set_collide("grains", "grains", false);
  world.set_velocities(grains, velocity);
  EXPECT_TRUE(world.step(dt).ok());
  const auto x = world.positions(grains);
  return static_cast<int>(
      std::count_if(x.begin(), x.end(), [&](const Vec3f& p) { return length(Vec3d(p) - center) > 1.05; }));
}

Settings one_substep(Detection detection, SegmentTest test) {
  return {.substeps = 1, .gravity = {}, .detection = detection, .segment_test = test};
}

TEST(DiscreteDetection, NoTestLetsThroughWhatHitsTheInsideOfATriangle) {
  const TriangleMesh ball = ball_at({});
  for (const auto& [name, test] : segment_test_names)
    EXPECT_EQ(shots_through(one_substep(Detection::discrete, test), ball, {}, centroids(ball)), 0) << name;
}

TEST(DiscreteDetection, CornersAndEdgesShowTheTest) {
  std::vector<int> through;
  for (const auto& [name, test] : segment_test_names) {
    int sum = 0;
    for (const Vec3d& center : {Vec3d{}, Vec3d{1.1, -2.2, 3.7}, Vec3d{-4.3, 0.7, 2.9}}) {
      const TriangleMesh ball = ball_at(center);
      sum += shots_through(one_substep(Detection::discrete, test), ball, center, corners_and_edges(ball));
    }
    through.push_back(sum);
    if (test == SegmentTest::watertight) {
      EXPECT_EQ(sum, 0);
    }
    if (test == SegmentTest::moeller_trumbore) {
      EXPECT_GT(sum, 0);
    }
  }
  EXPECT_GT(*std::max_element(through.begin(), through.end()), 10);
}

TEST(DiscreteDetection, ContinuousDetectionDoesNotDependOnTheTest) {
  const Vec3d center{1.1, -2.2, 3.7};
  const TriangleMesh ball = ball_at(center);
  const Settings settings = one_substep(Detection::continuous, SegmentTest::moeller_trumbore);
  EXPECT_EQ(shots_through(settings, ball, center, corners_and_edges(ball)), 0);
}

TEST(DiscreteDetection, AClothLiesOnTriangles) {
  World world({.detection = Detection::discrete});
  world.add_obstacle(grid(7, 7, 2));
  const ObjectId cloth =
      world.add_cloth(grid(9, 9, 0.5), material::cotton, {.transform = {.translation = {0, 0.1, 0}}});
  for (int frame = 0; frame < 120; ++frame) ASSERT_TRUE(world.step(dt).ok());
  for (const Vec3f& x : world.positions(cloth)) {
    EXPECT_GT(x.y, 0);
    EXPECT_LT(x.y, 0.004f);
  }
  EXPECT_GT(world.report().contacts, 40u);
}

TEST(DiscreteDetection, AMovingTriangleMeetsAVertexAtRest) {
  World world({.gravity = {}, .wind = {.air_density = 0}, .detection = Detection::discrete});
  const ObjectId cloth = world.add_cloth(grid(3, 3, 1), {}, {.velocity = {0, 20, 0}});
  const std::vector<Vec3d> point{{0.11, 0.2, 0.07}};
  const ObjectId grain = world.add_grains(point, {.radius = 1e-3f});
  const Vec3d before = world.momentum(cloth) + world.momentum(grain);
  for (int frame = 0; frame < 2; ++frame) ASSERT_TRUE(world.step(dt).ok());
  EXPECT_GT(world.velocities(grain)[0].y, 5);
  const Vec3d after = world.momentum(cloth) + world.momentum(grain);
  EXPECT_NEAR(length(after - before), 0, 1e-6 * length(before));
}

TEST(DiscreteDetection, AWarmStepAllocatesNothing) {
  World world({.detection = Detection::discrete, .threads = 1});
  world.add_obstacle(grid(7, 7, 2));
  world.add_cloth(grid(9, 9, 0.5), material::cotton, {.transform = {.translation = {0, 0.1, 0}}});
  for (int frame = 0; frame < 60; ++frame) ASSERT_TRUE(world.step(dt).ok());
  ASSERT_GT(world.report().contacts, 40u);
  const long before = allocations();
  for (int frame = 0; frame < 10; ++frame) world.step(dt);
  EXPECT_EQ(allocations() - before, 0);
}

TEST(DiscreteDetection, DoesNotDependOnTheNumberOfThreads) {
  const auto run = [](int threads) {
    World world({.detection = Detection::discrete, .threads = threads});
    world.add_obstacle(sphere(3, 0.3));
    const ObjectId cloth =
        world.add_cloth(grid(30, 30, 1), material::cotton, {.transform = {.translation = {0, 0.35, 0}}});
    for (int frame = 0; frame < 30; ++frame) world.step(dt);
    const auto x = world.positions(cloth);
    return std::vector<Vec3f>(x.begin(), x.end());
  };
  EXPECT_EQ(run(1), run(2));
}

}  // namespace souple::test::test_segment_triangle_discrete
