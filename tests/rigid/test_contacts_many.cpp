#include "tests/count_allocations.h"
#include "tests/rigid/rigid_scene.h"

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include <gtest/gtest.h>

// Many rigid bodies: the same with any number of threads, and what holds of all of them.

namespace souple::test {
namespace {

constexpr int dominoes = 200;

bool fallen(const BodyPose& pose) {
  return pose.direction({0, 1, 0}).y < 0.8;
}

/// Runs a row of dominoes until all have fallen, for 20 s at most; returns them in the order in which they fell.
std::vector<int> fall_of(RigidScene& scene) {
  for (int i = 0; i < dominoes; ++i) scene.box({0.01, 0.1, 0.05}, {i * 0.08, 0.1, 0}, {}, 600);
  scene.bodies.velocity[0] = {{0.3, 0, 0}, {0, 0, -3}};
  scene.plane();
  std::vector<int> order;
  std::vector<bool> is_down(dominoes, false);
  for (int f = 0; f < 1200 && order.size() < dominoes; ++f) {
    scene.step();
    for (int i = 0; i < dominoes; ++i)
      if (!is_down[static_cast<std::size_t>(i)] && fallen(scene.bodies.pose[static_cast<std::size_t>(i)]))
        order.push_back(i), is_down[static_cast<std::size_t>(i)] = true;
  }
  return order;
}

TEST(ManyRigidBodies, DominoesFallInOneOrderWithAnyNumberOfThreads) {
  RigidScene one(1);
  const std::vector<int> order = fall_of(one);
  ASSERT_EQ(order.size(), static_cast<std::size_t>(dominoes));
  EXPECT_TRUE(std::is_sorted(order.begin(), order.end()));
  for (const int threads : {2, 8}) {
    RigidScene several(threads);
    EXPECT_EQ(fall_of(several), order) << threads;
    EXPECT_TRUE(same_bits(several.bodies, one.bodies)) << threads;
  }
}

/// Boxes of 20 cm, turned at random, above a plane.
void drop_boxes(RigidScene& scene, int count) {
  std::mt19937 random(1);
  const auto uniform = [&random] { return static_cast<double>(random()) / 2147483648.0 - 1; };
  const int side = static_cast<int>(std::cbrt(count / 2.0));
  for (int i = 0; i < count; ++i) {
    Quatd q;
    q.x = uniform(), q.y = uniform(), q.z = uniform(), q.w = uniform();
    Vec3d x{i % side - side / 2.0, i / side / side + 1.0, i / side % side - side / 2.0};
    x.x += 0.1 * uniform(), x.z += 0.1 * uniform();
    scene.box({0.1, 0.1, 0.1}, x * 0.4, normalized(q));
  }
  scene.plane();
}

TEST(ManyRigidBodies, HeapOfBoxesIsTheSameWithEightThreadsAndComesToRest) {
  RigidScene scene, eight(8);
  drop_boxes(scene, 300), drop_boxes(eight, 300);
  eight.run(2);
  const double energy = scene.energy();
  double highest = energy;
  for (int f = 1; f <= 240; ++f) {
    scene.step();
    highest = std::max(highest, scene.energy());
    if (f == 120) EXPECT_TRUE(same_bits(scene.bodies, eight.bodies));
  }
  double lowest = 1;
  for (std::size_t i = 0; i < 300; ++i) lowest = std::min(lowest, scene.bodies.pose[i].position.y);
  EXPECT_LE(highest, energy);
  EXPECT_LT(scene.deepest(), 0.02 * 0.2);
  EXPECT_GT(lowest, 0.095);
}

TEST(ManyRigidBodies, WarmStepAllocatesNothing) {
  for (const int threads : {1, 2}) {
    RigidScene scene(threads);
    drop_boxes(scene, 60);
    scene.run(4);
    const long before = allocations();
    scene.run(1);
    EXPECT_EQ(allocations() - before, 0) << threads;
  }
}

}  // namespace
}  // namespace souple::test
