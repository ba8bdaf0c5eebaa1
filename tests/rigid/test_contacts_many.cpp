#include "tests/count_allocations.h"
#include "tests/rigid/rigid_scene.h"

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include <gtest/gtest.h>

// Many rigid bodies: the same with any number of threads, and what holds of all of them.

namespace souple::test::test_rigid_contacts_many {

constexpr int dominoes = 200;

bool fallen(const BodyPose& pose) {
  return pose.direction({0, 1, 0}).y < 0.8;
}

void add_dominoes(RigidScene& scene) {
  for (int i = 0; i < dominoes; ++i) scene.box({0.01, 0.1, 0.05}, {i * 0.08, 0.1, 0}, {}, 600);
  scene.bodies.velocity[0] = {{0.3, 0, 0}, {0, 0, -3}};
  scene.plane();
}

/// Steps until all dominoes have fallen, for 20 s at most; appends them in the order in which they fall.
class Fall {
 public:
  explicit Fall(RigidScene& scene) : scene_(scene), is_down_(dominoes, false) { add_dominoes(scene); }
  void run(int frames) {
    for (int f = 0; f < frames && order_.size() < dominoes; ++f) {
      scene_.step();
      for (std::size_t i = 0; i < dominoes; ++i)
        if (!is_down_[i] && fallen(scene_.bodies.pose[i])) order_.push_back(i), is_down_[i] = true;
    }
  }
  const std::vector<std::size_t>& order() const { return order_; }

 private:
  RigidScene& scene_;
  std::vector<bool> is_down_;
  std::vector<std::size_t> order_;
};

TEST(ManyRigidBodies, DominoesFallInOneOrderWithAnyNumberOfThreadsSlow) {
  RigidScene one(1), eight(8);
  Fall fall(one), fall_of_eight(eight);
  fall.run(1200), fall_of_eight.run(1200);
  EXPECT_TRUE(same_bits(eight.bodies, one.bodies));
  EXPECT_EQ(fall_of_eight.order(), fall.order());
  ASSERT_EQ(fall.order().size(), std::size_t{dominoes});
  EXPECT_TRUE(std::is_sorted(fall.order().begin(), fall.order().end()));
}

/// Boxes of 20 cm, turned at random, above a plane.
void drop_boxes(RigidScene& scene, int count) {
  std::mt19937 random(1);
  const auto uniform = [&random] { return static_cast<double>(random()) / 2147483648.0 - 1; };
  const int side = static_cast<int>(std::cbrt(count / 2.0));
  for (int i = 0; i < count; ++i) {
    Quatd q;
    q.x = uniform(), q.y = uniform(), q.z = uniform(), q.w = uniform();
    const int layer = i / side / side, row = i / side % side;
    Vec3d x{i % side - side / 2.0, layer + 1.0, row - side / 2.0};
    x.x += 0.1 * uniform(), x.z += 0.1 * uniform();
    scene.box({0.1, 0.1, 0.1}, x * 0.4, normalized(q));
  }
  scene.plane();
}

TEST(ManyRigidBodies, HeapOfBoxesComesToRest) {
  RigidScene scene(2);
  drop_boxes(scene, 300);
  const double energy = scene.energy();
  double highest = energy;
  for (int f = 1; f <= 240; ++f) {
    scene.step();
    highest = std::max(highest, scene.energy());
  }
  double lowest = 1;
  for (std::size_t i = 0; i < 300; ++i) lowest = std::min(lowest, scene.bodies.pose[i].position.y);
  EXPECT_LE(highest, energy);
  EXPECT_LT(scene.deepest(), 0.02 * 0.2);
  EXPECT_GT(lowest, 0.095);
}

TEST(ManyRigidBodies, WarmStepAllocatesNothing) {
  RigidScene scene(2);
  drop_boxes(scene, 60);
  scene.run(4);
  const long before = allocations();
  scene.run(1);
  EXPECT_EQ(allocations() - before, 0);
}

}  // namespace souple::test::test_rigid_contacts_many
